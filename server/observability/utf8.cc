#include "server/observability/utf8.h"

#include <cstddef>

namespace ballpiston::server {
namespace {

constexpr uint32_t kReplacement = 0xFFFD;
constexpr absl::string_view kReplacementBytes = "\xEF\xBF\xBD";

// The number of bytes of a character with this first byte; 0 if no character begins with it.
size_t Length(uint32_t first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  if (first >= 0xF0 && first < 0xF5) return 4;
  return 0;
}

uint32_t Byte(absl::string_view text, size_t i) { return static_cast<unsigned char>(text[i]); }

// Sets the code of the character. False if the bytes are not a character.
bool Decode(absl::string_view bytes, uint32_t& code) {
  constexpr uint32_t kFirstMask[] = {0, 0x7F, 0x1F, 0x0F, 0x07};
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  code = Byte(bytes, 0) & kFirstMask[bytes.size()];
  for (size_t i = 1; i < bytes.size(); ++i) {
    if ((Byte(bytes, i) & 0xC0) != 0x80) return false;
    code = code << 6 | (Byte(bytes, i) & 0x3F);
  }
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  return code >= kLeast[bytes.size()] && code <= 0x10FFFF && !surrogate;
}

}  // namespace

Utf8Character TakeUtf8(absl::string_view& text) {
  const size_t length = Length(Byte(text, 0));
  Utf8Character character{kReplacement, kReplacementBytes};
  uint32_t code = 0;
  if (length > 0 && length <= text.size() && Decode(text.substr(0, length), code)) {
    character = {code, text.substr(0, length)};
    text.remove_prefix(length);
  } else {
    text.remove_prefix(1);
  }
  return character;
}

}  // namespace ballpiston::server
