#include "core/arithmetic/number_text.h"

#include <charconv>
#include <iterator>

namespace ballpiston {

std::string NumberText(double value) {
  char text[32];
  return {text, std::to_chars(std::begin(text), std::end(text), value).ptr};
}

}  // namespace ballpiston
