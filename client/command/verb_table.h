// The program's verbs with their arguments and flags. The parser (command_line.h), help, man pages,
// the reference (reference.h) and shell completion (completion.cc) all use this one table.
//
// A new verb is a row here, its function in verbs.h and its file.
#pragma once

#include <string>
#include <vector>

#include "client/command/value.h"
#include "client/command/verbs.h"

namespace ballpiston::client {

inline constexpr char kProgram[] = "ballpiston";

struct Flag {
  std::string name;  // --rho; -q,--quiet; empty: only the variable sets the value
  Value value;
  std::string text;
  std::string variable = "";  // environment variable, used if the flag is not given
  bool is_required = false;
  bool is_everyday = true;  // else the short help only names the flag
};

struct FlagGroup {
  std::string title;
  std::vector<Flag> flags;
  bool is_everyday = true;  // else none of its flags is
};

struct Argument {
  Value value;
  std::string text;
  // kSeveral: at least one; kRest: any number, after --.
  enum { kRequired, kOptional, kSeveral, kAny, kRest } number = kRequired;

  bool IsMany() const { return number >= kSeveral; }
  bool IsRequired() const { return number == kRequired || number == kSeveral; }
};

struct Verb {
  std::string name;  // run; server start
  std::string summary;
  std::string description;
  std::vector<Argument> arguments;
  std::vector<const FlagGroup*> groups;
  std::vector<std::string> examples;  // without the program's name
  VerbFunction* act;
  // Options::words gets all words but the verb's flags, also unknown flags, in their order; a flag
  // may append to them (Forwarded). Then the arguments are only described.
  bool passes_words_on = false;
};

// In the order in which help shows them.
const std::vector<Verb>& Verbs();

// The verb whose name is the first of these words, such as server start; null if there is none.
const Verb* VerbAt(const std::vector<std::string>& words);
int WordsIn(const std::string& verb_name);
// The words that can follow `begin` in the name of a verb: start, stop, ... for "server ".
std::vector<std::string> NextWords(const std::string& begin);

// The flags that choose the server, and the flags of the target.
const FlagGroup& ServerFlags();
const FlagGroup& TargetFlags();
// The groups that make a specification.
const std::vector<const FlagGroup*>& QuestionFlags();

// The words of --format and of --progress.
inline const Choices<Format> kFormats = {{"table", Format::kTable},
                                         {"json", Format::kJson},
                                         {"jsonl", Format::kJsonl},
                                         {"csv", Format::kCsv}};
inline const Choices<ProgressStyle> kProgressStyles = {{"auto", ProgressStyle::kAuto},
                                                       {"bar", ProgressStyle::kBar},
                                                       {"json", ProgressStyle::kJson},
                                                       {"none", ProgressStyle::kNone}};

// The exit codes, and the files and variables that the program reads: (name, text).
struct Remark {
  std::string name, text;
};
extern const std::vector<Remark> kExitCodes, kFiles;

bool IsOf(const FlagGroup& group, const Flag& flag);

// All flags of the verb.
std::vector<const Flag*> FlagsOf(const Verb& verb);

// --rho for --rho; --quiet for -q,--quiet; empty if only the variable sets the value.
std::string LongName(const Flag& flag);

// Its key in the config file: token-file for --token-file and for BALLPISTON_TOKEN_FILE.
std::string KeyOf(const Flag& flag);

}  // namespace ballpiston::client
