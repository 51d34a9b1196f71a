// The words after the name of a verb, sorted into flags and arguments. The parser (command_line.h)
// and shell completion (completion.cc) read words in this way.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "client/command/verb_table.h"

namespace ballpiston::client {

struct SortedWords {
  std::vector<std::pair<const Flag*, std::string>> flags;  // with their values
  std::vector<std::string> arguments;  // all other words, also flags that the verb does not have
  std::string unknown_flag;            // the first of these
  const Flag* flag_without_value = nullptr;  // the first one: --rho at the end, or --rho=
  bool has_help = false;                     // --help or -h
};

// --flag VALUE is the same as --flag=VALUE. After a flag, neither another flag of the verb nor any
// word that begins with -- is a value. After -- all words are arguments.
SortedWords SortWords(const Verb& verb, const std::vector<std::string>& words);

}  // namespace ballpiston::client
