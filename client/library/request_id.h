// Ids for calls that must not take effect twice.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace ballpiston::client {

// A random UUID (version 4), from the system's source of randomness.
std::string NewRequestId();

// The UUID (version 8) of a text. Every process and version of this program gives the same UUID.
std::string RequestIdFor(absl::string_view text);

}  // namespace ballpiston::client
