#include "client/command/settings.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/command/suggestion.h"
#include "client/library/local_server.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

// ---- words ----

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

// ---- the config file ----

const Flag* FlagWithKey(const Verb& verb, const std::string& key) {
  for (const Flag* flag : FlagsOf(verb)) {
    if (KeyOf(*flag) == key) return flag;
  }
  return nullptr;
}

// The keys of the verb, or of all verbs if the name is empty.
std::vector<std::string> Keys(const std::string& verb_name) {
  std::set<std::string> keys;
  for (const Verb& verb : Verbs()) {
    if (!verb_name.empty() && verb.name != verb_name) continue;
    for (const Flag* flag : FlagsOf(verb)) {
      if (!flag->name.empty()) keys.insert(KeyOf(*flag));
    }
  }
  return {keys.begin(), keys.end()};
}

absl::Status CheckKey(const std::string& section, const std::string& key) {
  std::vector<std::string> keys = Keys(section);
  keys.erase(std::remove(keys.begin(), keys.end(), "config"), keys.end());
  if (keys.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("[", section, "] is not a verb"));
  }
  if (std::find(keys.begin(), keys.end(), key) != keys.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(Quoted(key), " is not a flag",
                                                 section.empty() ? "" : " of " + section,
                                                 DidYouMean(key, keys)));
}

// Whether a quote in the text is still open at its end.
bool EndsInQuotes(absl::string_view text) {
  char quote = '\0';  // the open one
  for (const char c : text) {
    if (c == quote) {
      quote = '\0';
    } else if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    }
  }
  return quote != '\0';
}

// CLI11's reader makes a list of two adjacent lines of a key, and cuts a value at # also in quotes.
absl::Status CheckLines(const std::string& path) {
  std::ifstream file(path);
  std::set<std::string> keys;
  std::string section, line;
  for (int number = 1; std::getline(file, line); ++number) {
    absl::StripAsciiWhitespace(&line);
    if (absl::StartsWith(line, ";")) continue;  // a comment, as a line that begins with #
    if (absl::StartsWith(line, "[")) section = line;
    const size_t equals = line.find('='), hash = line.find('#');
    if (equals == line.npos || hash < equals) continue;
    const std::string key(absl::StripAsciiWhitespace(line.substr(0, equals)));
    const bool is_cut = hash != line.npos && EndsInQuotes(line.substr(0, hash));
    if (keys.insert(section + key).second && !is_cut) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        path, ":", number, ": ", Quoted(key),
        is_cut ? " has # inside quotes, where it begins a comment; permitted: values without #"
               : " is given more than once"));
  }
  return absl::OkStatus();
}

// Adds first the settings below [VERB], then those for all verbs.
absl::Status AddConfig(const std::string& path, const Verb& verb, Settings& settings) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, " is a folder"));
  }
  std::vector<CLI::ConfigItem> items;
  try {
    items = CLI::ConfigTOML().from_file(path);
  } catch (const CLI::Error& error) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", error.what()));
  }
  if (absl::Status bad = CheckLines(path); !bad.ok()) return bad;
  for (const std::string& wanted : {verb.name, std::string()}) {
    for (const CLI::ConfigItem& item : items) {
      const std::string section = absl::StrJoin(item.parents, " ");
      if (item.name == "++" || item.name == "--") continue;  // a section's begin and end
      if (absl::Status bad = CheckKey(section, item.name); !bad.ok()) {
        return absl::InvalidArgumentError(absl::StrCat(path, ": ", bad.message()));
      }
      const Flag* const flag = FlagWithKey(verb, item.name);
      if (section != wanted || flag == nullptr) continue;
      const Source source = section.empty() ? Source::kFile : Source::kSection;
      settings.try_emplace(flag, Setting{absl::StrJoin(item.inputs, ","), source});
    }
  }
  return absl::OkStatus();
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
      const auto [given, is_first] = sorted.flags.try_emplace(flag, *value);
      if (is_first) continue;
      absl::StrAppend(&given->second, ",", *value);
      if (!flag->value.is_repeatable && sorted.repeated_flag == nullptr) {
        sorted.repeated_flag = flag;
      }
    } else if (sorted.flag_without_value == nullptr) {
      sorted.flag_without_value = flag;
    }
  }
  return sorted;
}

absl::StatusOr<Settings> ReadSettings(const Verb& verb, const SortedWords& words) {
  Settings settings;
  for (const auto& [flag, text] : words.flags) settings[flag] = {text, Source::kCommandLine};
  for (const Flag* flag : FlagsOf(verb)) {
    std::string text = FromEnvironment(flag->variable);
    if (!text.empty()) settings.try_emplace(flag, Setting{std::move(text), Source::kVariable});
  }
  std::string path = UsualConfig();
  for (const auto& [flag, setting] : settings) {
    if (LongName(*flag) == "--config") path = setting.text;
  }
  if (path.empty() || verb.act == &Help) return settings;
  if (absl::Status bad = AddConfig(path, verb, settings); !bad.ok()) return bad;
  return settings;
}

std::string FromEnvironment(const std::string& variable) {
  const char* value = std::getenv(variable.c_str());
  return value == nullptr ? "" : value;
}

std::string UsualConfig() {
  std::string folder = FromEnvironment("XDG_CONFIG_HOME");
  if (folder.empty() || folder[0] != '/') folder = HomeFolder() + "/.config";
  std::error_code error;
  const std::string path = folder + "/ballpiston/config.toml";
  return std::filesystem::exists(path, error) ? path : "";
}

}  // namespace ballpiston::client
