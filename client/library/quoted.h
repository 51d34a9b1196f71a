// Wrong values in error messages. Short values are shown whole, long values are shortened to a line
// or two. Control characters are escaped, so that they do not change the terminal.
#pragma once

#include <cstddef>
#include <string>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

inline constexpr size_t kLongestQuoted = 100;    // bytes
inline constexpr size_t kLongestMessage = 1000;  // bytes, of another program's message

// A text of more than `longest` bytes becomes "begin ... end". It is cut between UTF-8 characters.
inline std::string Shortened(absl::string_view text, size_t longest) {
  if (text.size() <= longest) return std::string(text);
  const auto is_inside = [text](size_t i) {
    return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80;
  };
  size_t begin = longest / 2;
  size_t end = text.size() - longest / 2;
  while (begin > 0 && is_inside(begin)) --begin;
  while (end < text.size() && is_inside(end)) ++end;
  return absl::StrCat(text.substr(0, begin), " ... ", text.substr(end));
}

// 'text'
inline std::string Quoted(absl::string_view text) {
  return absl::StrCat("'", absl::CHexEscape(Shortened(text, kLongestQuoted)), "'");
}

}  // namespace ballpiston::client
