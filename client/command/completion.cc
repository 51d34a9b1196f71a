// ballpiston completion: scripts for three shells. A script runs `completion words -- WORD...` to
// get the possible words, which come from the table of verbs.
#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "absl/time/time.h"
#include "client/command/connection.h"
#include "client/command/verb_table.h"

namespace ballpiston::client {
namespace {

using Strings = std::vector<std::string>;

// Each script passes the words so far; the last word is the word to complete. The answer FILES
// means that the shell completes names of files. bash splits --flag=value into three words.
constexpr char kBash[] = R"bash(# bash completion for ballpiston
_ballpiston() {
  local words=("${COMP_WORDS[@]:1:COMP_CWORD}") word=${COMP_WORDS[COMP_CWORD]} offers
  [[ $word == = ]] && word=
  mapfile -t offers < <(ballpiston completion words -- "${words[@]}" 2>/dev/null)
  if [[ ${offers[0]} == FILES ]]; then
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -W "${offers[*]%%$'\t'*}" -- "$word")
  fi
}
complete -F _ballpiston ballpiston
)bash";

constexpr char kZsh[] = R"zsh(#compdef ballpiston
_ballpiston() {
  local -a offers
  offers=(${(f)"$(ballpiston completion words -- "${(@)words[2,CURRENT]}" 2>/dev/null)"})
  if [[ $offers[1] == FILES ]]; then _files; else
    offers=(${offers//$'\t'/:})
    _describe ballpiston offers
  fi
}
if [[ $funcstack[1] == _ballpiston ]]; then _ballpiston "$@"; else compdef _ballpiston ballpiston; fi
)zsh";

constexpr char kFish[] = R"fish(# fish completion for ballpiston
function __ballpiston_offers
  set -l words (commandline -opc) (commandline -ct)
  set -l offers (ballpiston completion words -- $words[2..-1] 2>/dev/null)
  if test "$offers[1]" = FILES
    __fish_complete_path (commandline -ct)
  else
    string join \n -- $offers
  end
end
complete -c ballpiston -f -a '(__ballpiston_offers)'
)fish";

// The flag that `word` names, if that flag takes a value; else null.
const Flag* FlagWithValue(const Verb& verb, const std::string& word) {
  for (const Flag* flag : FlagsOf(verb)) {
    if (!flag->name.empty() && !flag->value.IsSwitch() && LongName(*flag) == word) return flag;
  }
  return nullptr;
}

// The argument at the position of the last word; null if the verb has no further argument.
const Argument* ArgumentAt(const Verb& verb, const Strings& words) {
  size_t before = 0;
  for (size_t i = static_cast<size_t>(WordsIn(verb.name)); i + 1 < words.size(); ++i) {
    const bool is_flag = absl::StartsWith(words[i], "-");
    if (!is_flag) ++before;
    if (is_flag && FlagWithValue(verb, words[i]) != nullptr) ++i;
  }
  if (before < verb.arguments.size()) return &verb.arguments[before];
  if (verb.arguments.empty()) return nullptr;
  const Argument& last = verb.arguments.back();
  return last.IsMany() ? &last : nullptr;
}

// The possible next words of the verbs that begin with the words so far; a whole name has its
// summary.
Strings VerbOffers(Strings so_far) {
  so_far.back() = "";
  const std::string begin = absl::StrJoin(so_far, " ");
  Strings offers = NextWords(begin);
  std::sort(offers.begin(), offers.end());
  for (std::string& offer : offers) {
    const auto is_whole = [&](const Verb& verb) { return verb.name == begin + offer; };
    const auto verb = std::find_if(Verbs().begin(), Verbs().end(), is_whole);
    if (verb != Verbs().end()) absl::StrAppend(&offer, "\t", verb->summary);
  }
  return offers;
}

// The names of the newest jobs. Empty if no server runs: completion starts no server.
Strings JobNames(const Options& options, const Terminal& terminal) {
  constexpr int kMost = 50;
  constexpr absl::Duration kTimeout = absl::Seconds(1);  // the user waits for the shell
  v1::ListEnsembleJobsRequest request;
  request.set_view(v1::ListEnsembleJobsRequest::BASIC);
  Strings names;
  const auto list = [&](const Connection& connection) -> VerbResult {
    const auto jobs = Client(connection.channel, kTimeout).List(request, kMost);
    if (!jobs.ok()) return jobs.status();
    for (const v1::EnsembleJob& job : *jobs) names.push_back(job.name());
    return ExitCode::kDone;
  };
  const VerbResult ignored = WithServer(options, terminal, list, /*may_start=*/false);
  return names;
}

Strings ValueOffers(const Value& value, const Options& options, const Terminal& terminal) {
  switch (value.offer) {
    case Offer::kChoices:
      return value.choices;
    case Offer::kFile:
      return {"FILES"};
    case Offer::kJob:
      return JobNames(options, terminal);
    case Offer::kFigure:
      return FigureNames();
    case Offer::kNothing:
      break;
  }
  return {};
}

Strings FlagOffers(const Verb& verb) {
  Strings offers;
  for (const Flag* flag : FlagsOf(verb)) {
    if (!flag->name.empty()) offers.push_back(absl::StrCat(LongName(*flag), "\t", flag->text));
  }
  return offers;
}

// bash also splits words at colons: the address of a server becomes three words.
void JoinAtColons(Strings& words) {
  Strings joined;
  for (std::string& word : words) {
    const bool follows = !joined.empty() && (word == ":" || absl::EndsWith(joined.back(), ":"));
    if (follows) {
      joined.back() += word;
    } else {
      joined.push_back(std::move(word));
    }
  }
  words = std::move(joined);
}

// Splits --flag=value into two words. bash passes it as three words, zsh and fish as one word. zsh
// and fish need offers that begin with --flag= too: returns this prefix for them, else "".
std::string SplitValue(Strings& words) {
  if (words.back() == "=") words.back() = "";
  std::erase(words, "=");
  const std::string last = words.back();
  const size_t equals = last.find('=');
  if (!absl::StartsWith(last, "--") || equals == std::string::npos) return "";
  words.back() = last.substr(0, equals);
  words.push_back(last.substr(equals + 1));
  return last.substr(0, equals + 1);
}

// The server that the words name; empty if none.
std::string ServerIn(const Strings& words) {
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    absl::string_view word = words[i];
    if (word == "--server" && i + 2 < words.size()) return words[i + 1];
    if (absl::ConsumePrefix(&word, "--server=")) return std::string(word);
  }
  return "";
}

Strings Offers(Strings words, Options options, const Terminal& terminal) {
  if (words.empty()) words = {""};
  JoinAtColons(words);
  const std::string prefix = SplitValue(words);
  if (const std::string server = ServerIn(words); !server.empty()) options.server = server;
  const Verb* const verb = VerbAt({words.begin(), words.end() - 1});
  if (verb == nullptr) return VerbOffers(words);
  if (const Flag* const flag = FlagWithValue(*verb, words[words.size() - 2])) {
    Strings offers = ValueOffers(flag->value, options, terminal);
    if (!prefix.empty() && flag->value.offer == Offer::kFile) return {};
    for (std::string& offer : offers) offer.insert(0, prefix);
    return offers;
  }
  if (!prefix.empty()) return {};
  const Argument* const argument = ArgumentAt(*verb, words);
  if (absl::StartsWith(words.back(), "-") || argument == nullptr) return FlagOffers(*verb);
  if (verb->act == &Help) {
    words.erase(words.begin());
    return VerbOffers(words);
  }
  const Strings values = ValueOffers(argument->value, options, terminal);
  return values.empty() ? FlagOffers(*verb) : values;
}

}  // namespace

VerbResult Complete(const Options& options, Terminal& terminal) {
  switch (options.completion) {
    case Completion::kBash:
      terminal.out << kBash;
      break;
    case Completion::kZsh:
      terminal.out << kZsh;
      break;
    case Completion::kFish:
      terminal.out << kFish;
      break;
    case Completion::kWords:
      for (const std::string& offer : Offers(options.words, options, terminal)) {
        terminal.out << offer << '\n';
      }
  }
  return ExitCode::kDone;
}

}  // namespace ballpiston::client
