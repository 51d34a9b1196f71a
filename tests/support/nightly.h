// The size of tests: small by default; full with BALLPISTON_NIGHTLY=1 in the environment (`make
// test-long`, part of `make nightly`).
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>

#include "absl/strings/numbers.h"

namespace ballpiston {

inline bool IsNightly() { return std::getenv("BALLPISTON_NIGHTLY") != nullptr; }

// The number in a test's own environment variable; empty if the variable is not set. Throws
// std::invalid_argument if its value is not a whole number.
inline std::optional<uint64_t> NumberFromEnvironment(const char* name) {
  const char* const text = std::getenv(name);
  if (text == nullptr) return std::nullopt;
  uint64_t number = 0;
  if (absl::SimpleAtoi(text, &number)) return number;
  throw std::invalid_argument(std::string(name) + " is no whole number: " + text);
}

}  // namespace ballpiston
