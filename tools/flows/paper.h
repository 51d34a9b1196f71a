// Parameters of the paper.
#pragma once

namespace ballpiston {

// The radius rho of the paper's figures, (sqrt(33) - 2)/(5 sqrt(2)), to 15 digits.
inline constexpr double kPaperRho = 0.529561127988977;

}  // namespace ballpiston
