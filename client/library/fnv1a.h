// The hash FNV-1a, 64 bits: the same number in every process and version of this program.
#pragma once

#include <cstdint>

#include "absl/strings/string_view.h"

namespace ballpiston::client {

inline constexpr uint64_t kFnv1aBasis = 0xcbf29ce484222325;

// Another basis gives another hash.
inline uint64_t Fnv1a(absl::string_view text, uint64_t basis = kFnv1aBasis) {
  for (const char c : text) basis = (basis ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return basis;
}

}  // namespace ballpiston::client
