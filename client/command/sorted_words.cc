#include "client/command/sorted_words.h"

#include <algorithm>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {
namespace {

bool IsHelp(absl::string_view name) { return name == "--help" || name == "-h"; }

// --rho for --rho=0.5.
std::string NameIn(const std::string& word) { return word.substr(0, word.find('=')); }

const Flag* FlagNamed(const Verb& verb, const std::string& name) {
  for (const Flag* flag : FlagsOf(verb)) {
    const std::vector<std::string> names = absl::StrSplit(flag->name, ',', absl::SkipEmpty());
    if (std::find(names.begin(), names.end(), name) != names.end()) return flag;
  }
  return nullptr;
}

}  // namespace

SortedWords SortWords(const Verb& verb, const std::vector<std::string>& words) {
  SortedWords sorted;
  for (auto word = words.begin(); word != words.end(); ++word) {
    if (*word == "--") {
      sorted.arguments.insert(sorted.arguments.end(), word + 1, words.end());
      break;
    }
    const std::string name = NameIn(*word);
    const Flag* const flag = FlagNamed(verb, name);
    if (flag == nullptr) {
      sorted.has_help = sorted.has_help || IsHelp(name);
      if (sorted.unknown_flag.empty() && absl::StartsWith(name, "-")) sorted.unknown_flag = name;
      sorted.arguments.push_back(*word);
      continue;
    }
    std::optional<std::string> value;
    const auto next = word + 1;
    if (name != *word) {
      value = word->substr(name.size() + 1);
      if (value->empty()) value.reset();
    } else if (flag->value.IsSwitch()) {
      value = "true";
    } else if (next != words.end() && !absl::StartsWith(*next, "--") && !IsHelp(*next) &&
               FlagNamed(verb, NameIn(*next)) == nullptr) {
      value = *++word;
    }
    if (value) {
      sorted.flags.emplace_back(flag, *value);
    } else if (sorted.flag_without_value == nullptr) {
      sorted.flag_without_value = flag;
    }
  }
  return sorted;
}

}  // namespace ballpiston::client
