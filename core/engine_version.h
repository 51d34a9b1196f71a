// The version of the numerical results. Raise it whenever a specification may give other bits.
#pragma once

namespace ballpiston {

inline constexpr char kEngineVersion[] = "0.24.0";

}  // namespace ballpiston
