// The size of tests: small by default; full with BALLPISTON_NIGHTLY=1 in the environment (`make
// test-long`, part of `make nightly`).
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

namespace ballpiston {

inline bool IsNightly() { return std::getenv("BALLPISTON_NIGHTLY") != nullptr; }

// Of a test with variables of its own.
inline std::optional<uint64_t> NumberFromEnvironment(const char* name) {
  const char* const text = std::getenv(name);
  return text == nullptr ? std::nullopt : std::optional<uint64_t>(std::stoull(text));
}

}  // namespace ballpiston
