#include "tests/layout/include_rules.h"

#include <algorithm>
#include <array>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

struct Rule {
  std::string folder;
  std::vector<std::string> may_include;  // prefixes
  bool operating_system = false;
};

// A row begins with a folder and a colon; the words after it, on this line and the next ones, are
// what it may include.
std::vector<Rule> ReadRules() {
  std::istringstream lines(Contents(SourcePath("tests/layout/include_rules.txt")));
  std::vector<Rule> rules;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (word.ends_with(":")) {
        word.pop_back();
        rules.push_back({.folder = word, .may_include = {word}});
      } else if (word == "system") {
        rules.back().operating_system = true;
      } else {
        rules.back().may_include.push_back(word);
      }
    }
  }
  return rules;
}

template <typename Prefixes>
bool StartsWithAny(std::string_view path, const Prefixes& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](std::string_view prefix) { return path.starts_with(prefix); });
}

// Whether a header of C++ or Abseil has threads or clocks.
bool IsThreadOrClock(std::string_view include) {
  constexpr std::array<std::string_view, 8> kPrefixes = {"thread",
                                                         "future",
                                                         "mutex",
                                                         "condition_variable",
                                                         "chrono",
                                                         "ctime",
                                                         "absl/synchronization/",
                                                         "absl/time/"};
  return StartsWithAny(include, kPrefixes);
}

// <vector>, <cmath>, ...
bool IsStandardHeader(std::string_view include) {
  return include.find_first_of("/.") == std::string_view::npos;
}

// <unistd.h>, <sys/stat.h>, <thread>, ...
bool IsOperatingSystemHeader(std::string_view include) {
  constexpr std::array<std::string_view, 3> kFolders = {"sys/", "arpa/", "netinet/"};
  if (include == "sqlite3.h") return false;
  return include.find('/') == std::string_view::npos || StartsWithAny(include, kFolders);
}

bool IsAllowed(const Rule& rule, std::string_view include) {
  if (IsThreadOrClock(include) && !rule.operating_system) return false;
  return IsStandardHeader(include) || StartsWithAny(include, rule.may_include) ||
         (rule.operating_system && IsOperatingSystemHeader(include));
}

// The core's physics and the API's messages meet in server/convert only.
bool JoinsPhysicsAndMessages(std::string_view path, const std::vector<std::string>& includes) {
  if (!path.starts_with("server/") || path.starts_with("server/convert/")) return false;
  const auto some = [&](std::string_view prefix) {
    return std::any_of(includes.begin(), includes.end(),
                       [&](const std::string& include) { return include.starts_with(prefix); });
  };
  return some("core/") && some("ballpiston/v1/");
}

}  // namespace

std::vector<std::string> IncludesOf(std::string_view text) {
  static const std::regex kInclude(R"([ \t]*#[ \t]*include[ \t]*[<"]([^>"]*)[>"].*)");
  std::vector<std::string> found;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    const size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] != '#') continue;
    std::smatch include;
    if (std::regex_match(line, include, kInclude)) found.push_back(include[1]);
  }
  return found;
}

std::vector<std::string> WrongIncludes(std::string_view path, std::string_view text) {
  static const auto* const rules = new std::vector<Rule>(ReadRules());
  const std::string file(path);
  const auto rule = std::find_if(rules->begin(), rules->end(),
                                 [&](const Rule& row) { return path.starts_with(row.folder); });
  if (rule == rules->end()) return {file + " lies in a folder without a rule"};

  std::vector<std::string> wrong;
  const std::vector<std::string> includes = IncludesOf(text);
  for (const std::string& include : includes) {
    if (!IsAllowed(*rule, include)) wrong.push_back(file + " may not include " + include);
  }
  if (JoinsPhysicsAndMessages(path, includes)) {
    wrong.push_back(file + " includes core/ and ballpiston/v1/; only server/convert/ may");
  }
  return wrong;
}

}  // namespace ballpiston
