// Parameters of the paper.
#ifndef BALLPISTON_CORE_GEOMETRY_PAPER_H_
#define BALLPISTON_CORE_GEOMETRY_PAPER_H_

namespace ballpiston {

// The radius rho of the paper's figures, (sqrt(33) - 2)/(5 sqrt(2)), to 15 digits.
inline constexpr double kPaperRho = 0.529561127988977;

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GEOMETRY_PAPER_H_
