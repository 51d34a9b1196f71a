// The text of a number in messages: the shortest decimal text that parses to the same double.
#pragma once

#include <charconv>
#include <iterator>
#include <string>

namespace ballpiston {

inline std::string NumberText(double value) {
  char text[32];
  return {text, std::to_chars(std::begin(text), std::end(text), value).ptr};
}

}  // namespace ballpiston
