// The version of the numerical results. Raise it whenever a specification may give other bits.
#ifndef BALLPISTON_CORE_ENGINE_VERSION_H_
#define BALLPISTON_CORE_ENGINE_VERSION_H_

namespace ballpiston {

inline constexpr char kEngineVersion[] = "0.12.0";

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_ENGINE_VERSION_H_
