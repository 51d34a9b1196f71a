// SHA-256, by OpenSSL. Pure function.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace ballpiston::server {

inline constexpr size_t kSha256Bytes = 32;

// The hash has kSha256Bytes bytes.
std::string Sha256(absl::string_view bytes);

}  // namespace ballpiston::server
