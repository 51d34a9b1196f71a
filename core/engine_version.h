// The version of the numerical results. Raise it whenever a specification may give other bits.
#pragma once

#include <string>

namespace ballpiston {

inline constexpr char kEngineVersion[] = "0.27.0";

// The version in this process. It ends with "-unfused" where the vector code has no fused
// multiply-add, because its results differ in the last bits: what one process computed is not
// continued or merged by another kind of process.
std::string EngineVersion();

}  // namespace ballpiston
