// The version of the program's releases. Computed results have a version of their own:
// EngineVersion (convert/spec.h).
#ifndef BALLPISTON_SERVER_VERSION_H_
#define BALLPISTON_SERVER_VERSION_H_

namespace ballpiston::server {

inline constexpr char kVersion[] = BALLPISTON_VERSION;  // set by CMake

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_VERSION_H_
