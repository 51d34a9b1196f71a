// Numbers that several pages state (docs/numbers.md). A page marks such a number with its name:
// 21<!--gain-rare-avx2-->.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ballpiston {

using SharedNumbers = std::map<std::string, std::string>;  // number, by its name

// The rows | `name` | number | ... | of the page.
SharedNumbers NumbersIn(const std::string& page);

struct MarkedNumber {
  std::string name;
  std::string before;  // the text of the line before the mark
};
std::vector<MarkedNumber> MarkedNumbersIn(const std::string& page);

// Whether the text before the mark ends with the number.
bool EndsWithNumber(const std::string& before, const std::string& number);

}  // namespace ballpiston
