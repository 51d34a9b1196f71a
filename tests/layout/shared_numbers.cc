#include "tests/layout/shared_numbers.h"

#include <cctype>
#include <regex>

namespace ballpiston {
namespace {

std::vector<std::smatch> Matches(const std::string& text, const std::regex& pattern) {
  return {std::sregex_iterator(text.begin(), text.end(), pattern), {}};
}

}  // namespace

SharedNumbers NumbersIn(const std::string& page) {
  static const std::regex row(R"(\n\| `([a-z0-9-]+)` \| ([^|\n]+) \|)");
  SharedNumbers numbers;
  for (const std::smatch& match : Matches(page, row)) numbers[match[1]] = match[2];
  return numbers;
}

std::vector<MarkedNumber> MarkedNumbersIn(const std::string& page) {
  static const std::regex mark("<!--([a-z0-9-]+)-->");
  std::vector<MarkedNumber> marked;
  for (const std::smatch& match : Matches(page, mark)) {
    const std::string before = page.substr(0, static_cast<size_t>(match.position()));
    marked.push_back({match[1], before.substr(before.rfind('\n') + 1)});
  }
  return marked;
}

bool EndsWithNumber(const std::string& before, const std::string& number) {
  if (!before.ends_with(number)) return false;
  const size_t rest = before.size() - number.size();
  return rest == 0 || std::isspace(static_cast<unsigned char>(before[rest - 1])) != 0;
}

}  // namespace ballpiston
