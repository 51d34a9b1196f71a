// The texts of a verb's flags and arguments. A flag that is not on the command line takes its value
// from its environment variable, otherwise from the config file.
//
// The config file has CLI11's form (TOML). FLAG = VALUE applies to every verb that has the flag;
// below [VERB] it applies only to that verb ([server.start] for server start). CLI11's own config
// file is not used: it would override the environment, and has no keys for all verbs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/verb_table.h"

namespace ballpiston::client {

// The words after the name of a verb, sorted into flags and arguments.
struct SortedWords {
  std::map<const Flag*, std::string> flags;  // values; those of a repeatable flag are joined
  std::vector<std::string> arguments;  // all other words, also flags that the verb does not have
  std::string unknown_flag;            // the first flag that the verb does not have
  const Flag* flag_without_value = nullptr;  // the first one: --rho at the end, or --rho=
  const Flag* repeated_flag = nullptr;       // the first one that must not be repeated
  bool has_help = false;                     // --help or -h
};

// --flag VALUE is the same as --flag=VALUE. After a flag, neither another flag of the verb nor any
// word that begins with -- is a value. After -- all words are arguments.
SortedWords SortWords(const Verb& verb, const std::vector<std::string>& words);

// Sources are in the order of increasing priority. kSection is the verb's part of the config file.
enum class Source { kFile, kSection, kVariable, kCommandLine };
struct Setting {
  std::string text;
  Source source;
};
using Settings = std::map<const Flag*, Setting>;

// The strongest setting of each of the verb's flags. INVALID_ARGUMENT names the config file and its
// error, such as a key that is given twice.
absl::StatusOr<Settings> ReadSettings(const Verb& verb, const SortedWords& words);

// The value of a variable; empty if it is not set.
std::string FromEnvironment(const std::string& variable);

// The path of ~/.config/ballpiston/config.toml; empty if the file does not exist.
std::string UsualConfig();

}  // namespace ballpiston::client
