// The version of the program's releases. Computed results have a version of their own:
// EngineVersion (convert/spec.h).
#pragma once

namespace ballpiston::server {

inline constexpr char kVersion[] = BALLPISTON_VERSION;  // set by CMake

}  // namespace ballpiston::server
