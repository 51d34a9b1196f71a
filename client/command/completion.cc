// ballpiston completion: scripts for three shells. A script runs `completion words -- WORD...` to
// get the possible words, which come from the table of verbs.
#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "client/command/connection.h"
#include "client/command/settings.h"

namespace ballpiston::client {
namespace {

using Strings = std::vector<std::string>;

// Each script passes the words so far; the last word is the word to complete. The answer FILES
// means that the shell completes names of files. bash splits --flag=value into three words, and
// replaces only the last one. `compgen -W` would execute $(...) in an offer.
constexpr char kBash[] = R"bash(# bash completion for ballpiston
_ballpiston() {
  local words=("${COMP_WORDS[@]:1:COMP_CWORD}") word=${COMP_WORDS[COMP_CWORD]} offers offer
  [[ $word == = ]] && word=
  mapfile -t offers < <(ballpiston completion words -- "${words[@]}" 2>/dev/null)
  if [[ ${offers[0]} == FILES ]]; then
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  else
    COMPREPLY=()
    for offer in "${offers[@]%%$'\t'*}"; do
      offer=${offer#--*=}
      [[ $offer == "$word"* ]] && COMPREPLY+=("$offer")
    done
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

// The verb's argument after `others` earlier ones; null if the verb has no further argument.
const Argument* ArgumentAfter(size_t others, const Verb& verb) {
  if (others < verb.arguments.size()) return &verb.arguments[others];
  const bool is_open = !verb.arguments.empty() && verb.arguments.back().IsMany();
  return is_open ? &verb.arguments.back() : nullptr;
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

// Whether the text is one word that no shell changes or executes.
bool IsPlain(absl::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || absl::StrContains("/_-", c);
  });
}

// The names of the newest jobs. Empty if no server runs: completion starts no server. A server's
// name that is not plain is left out.
Strings JobNames(const Options& options, const Terminal& terminal) {
  constexpr int kMost = 50;
  constexpr absl::Duration kTimeout = absl::Seconds(1);  // the user waits for the shell
  v1::ListEnsembleJobsRequest request;
  request.set_view(v1::ListEnsembleJobsRequest::BASIC);
  Strings names;
  const auto list = [&](const Connection& connection) -> VerbResult {
    const auto jobs = Client(connection.channel, kTimeout).List(request, kMost);
    if (!jobs.ok()) return jobs.status();
    for (const v1::EnsembleJob& job : *jobs) {
      if (IsPlain(job.name())) names.push_back(job.name());
    }
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

// bash splits words at colons and equals signs: --server=unix:PATH is five words.
Strings Joined(const Strings& words) {
  const auto is_separator = [](const std::string& word) { return word == ":" || word == "="; };
  Strings joined = {""};
  for (size_t i = 0; i < words.size(); ++i) {
    const bool follows = i > 0 && (is_separator(words[i]) || is_separator(words[i - 1]));
    if (i == 0 || follows) {
      joined.back() += words[i];
    } else {
      joined.push_back(words[i]);
    }
  }
  return joined;
}

// The value of a flag can be a word of its own or follow --flag= in its word. In the second case
// the offers begin with --flag= too.
Strings Offers(const Strings& given, Options options, const Terminal& terminal) {
  Strings words = Joined(given);
  const Verb* const verb = VerbAt({words.begin(), words.end() - 1});
  if (verb == nullptr) return VerbOffers(words);
  const std::string last = words.back();
  const std::string prefix = absl::StartsWith(last, "--") ? last.substr(0, last.find('=') + 1) : "";
  Strings before(words.begin() + WordsIn(verb->name), words.end() - 1);
  if (!prefix.empty()) before.push_back(prefix);
  const SortedWords sorted = SortWords(*verb, before);
  for (const auto& [flag, text] : sorted.flags) {
    if (IsOf(ServerFlags(), *flag)) flag->value.read(text, options).IgnoreError();
  }
  if (sorted.flag_without_value != nullptr) {
    const Value& value = sorted.flag_without_value->value;
    Strings offers = ValueOffers(value, options, terminal);
    if (value.offer == Offer::kFile) return offers;
    for (std::string& offer : offers) offer.insert(0, prefix);
    return offers;
  }
  if (!prefix.empty()) return {};
  const Argument* const argument = ArgumentAfter(sorted.arguments.size(), *verb);
  if (absl::StartsWith(last, "-") || argument == nullptr) return FlagOffers(*verb);
  if (verb->act == &Help) return VerbOffers({words.begin() + 1, words.end()});
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
