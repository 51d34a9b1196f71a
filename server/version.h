// The version of the program, as releases are numbered; that of the numbers is the engine's.
#ifndef BALLPISTON_SERVER_VERSION_H_
#define BALLPISTON_SERVER_VERSION_H_

namespace ballpiston::server {

inline constexpr char kVersion[] = BALLPISTON_VERSION;  // set by CMake

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_VERSION_H_
