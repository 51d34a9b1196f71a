// Characters of UTF-8, one after the other. Pure function.
#pragma once

#include <cstdint>

#include "absl/strings/string_view.h"

namespace ballpiston::server {

struct Utf8Character {
  uint32_t code = 0;
  absl::string_view bytes;  // valid UTF-8
};

// Removes the first character from the text, which must not be empty. A byte that does not begin a
// valid character (cut short, overlong, a surrogate, beyond U+10FFFF) counts as the character
// U+FFFD.
Utf8Character TakeUtf8(absl::string_view& text);

}  // namespace ballpiston::server
