#include "client/command/command_line.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/command/reference.h"
#include "client/command/settings.h"
#include "client/command/suggestion.h"
#include "client/library/error_text.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

absl::Status Named(const std::string& name, const absl::Status& status) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(name, ": ", status.message()));
}

// Whether another command needs this flag to reach the same server.
bool IsOfConnection(const Flag& flag) {
  return LongName(flag) == "--config" || IsOf(ServerFlags(), flag);
}

std::string NameOf(const Flag& flag, Source source) {
  if (source == Source::kCommandLine) return LongName(flag);
  if (source == Source::kVariable) return flag.variable;
  return KeyOf(flag) + " of the config file";
}

// The text, quoted if needed, so that a shell reads it as one word.
std::string ShellWord(const std::string& text) {
  constexpr char kPlain[] =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=@%+,-";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"'", "'\\''"}}), "'");
}

absl::Status ReadFlag(const Flag& flag, const Setting& setting, Options& options) {
  if (setting.source == Source::kCommandLine) {
    options.given.insert(LongName(flag));
    if (IsOfConnection(flag)) {
      absl::StrAppend(&options.connection, " ", LongName(flag),
                      flag.value.IsSwitch() ? "" : " " + ShellWord(setting.text));
    }
  }
  return Named(NameOf(flag, setting.source), flag.value.read(setting.text, options));
}

absl::Status CheckOneTarget(const std::vector<std::string>& flags, const std::string& where) {
  const bool is_pair = flags == std::vector<std::string>{"--tolerance", "--budget"};
  if (flags.size() <= 1 || is_pair) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(absl::StrJoin(flags, " and "), where,
                   " exclude each other: give at most one of --samples, --collisions, --tolerance, "
                   "--budget; only --tolerance and --budget can be combined"));
}

// Reads the weakest source first, so that a flag from a stronger source also replaces flags that
// exclude it: --token-file replaces BALLPISTON_TOKEN, and --budget the tolerance of the config
// file. Of one source in the order of the table.
absl::Status ReadFlags(const Verb& verb, const Settings& settings, Options& options) {
  for (const Source source :
       {Source::kFile, Source::kSection, Source::kVariable, Source::kCommandLine}) {
    std::vector<std::string> targets;
    for (const Flag* flag : FlagsOf(verb)) {
      const auto setting = settings.find(flag);
      if (setting == settings.end() || setting->second.source != source) continue;
      if (IsOf(TargetFlags(), *flag)) {
        if (targets.empty()) {
          options.spec.mutable_target()->clear_kind();
          options.spec.mutable_target()->clear_budget();
        }
        targets.push_back(flag->name);
      }
      if (absl::Status bad = ReadFlag(*flag, setting->second, options); !bad.ok()) return bad;
    }
    const char* const where = source == Source::kCommandLine ? "" : " in the config file";
    if (absl::Status bad = CheckOneTarget(targets, where); !bad.ok()) return bad;
  }
  return absl::OkStatus();
}

std::string NoSuchFlag(const Verb* verb, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  std::vector<std::string> names = {"--help", "--version"};
  for (const Verb& any : Verbs()) {
    if (verb != nullptr && &any != verb) continue;
    for (const Flag* flag : FlagsOf(any)) {
      for (const absl::string_view part : absl::StrSplit(flag->name, ',')) {
        names.emplace_back(part);
      }
    }
  }
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    return absl::StrCat("write flags after the verb: ", Quoted(name));
  }
  return absl::StrCat(verb == nullptr ? kProgram : verb->name, " has no flag ", Quoted(name),
                      DidYouMean(name, names));
}

// The words name no verb. The first of them may name a group of verbs: server.
std::string NoSuchVerb(const std::vector<std::string>& words) {
  if (absl::StartsWith(words[0], "-")) return NoSuchFlag(nullptr, words[0]);
  std::vector<std::string> names = NextWords(words[0] + " ");
  const bool is_group = !names.empty();
  if (!is_group) names = NextWords("");
  const std::string& word = words[is_group ? 1 : 0];
  return absl::StrCat(Quoted(word), " is not a verb; verbs are ", absl::StrJoin(names, ", "),
                      DidYouMean(word, names));
}

absl::Status WrongUsage(const std::string& message, const Verb* verb) {
  return absl::InvalidArgumentError(absl::StrCat(message, " (", kProgram, " help",
                                                 verb == nullptr ? "" : " " + verb->name,
                                                 " shows its usage)"));
}

absl::Status CheckArguments(const Verb& verb, const SortedWords& words) {
  if (!words.unknown_flag.empty()) return WrongUsage(NoSuchFlag(&verb, words.unknown_flag), &verb);
  const size_t given = words.arguments.size(), named = verb.arguments.size();
  const bool is_open = named > 0 && verb.arguments.back().IsMany();
  if (given > named && !is_open) {
    return WrongUsage("not expected: " + Quoted(words.arguments[named]), &verb);
  }
  for (size_t i = given; i < named; ++i) {
    const Argument& argument = verb.arguments[i];
    if (!argument.IsRequired()) continue;
    return WrongUsage(absl::StrCat(verb.name, " needs ", argument.value.name, ": ", argument.text),
                      &verb);
  }
  return absl::OkStatus();
}

absl::Status CheckWords(const Verb& verb, const SortedWords& words) {
  if (words.flag_without_value != nullptr) {
    return WrongUsage(LongName(*words.flag_without_value) + " needs a value", &verb);
  }
  absl::Status status = verb.passes_words_on ? absl::OkStatus() : CheckArguments(verb, words);
  if (!status.ok() || words.repeated_flag == nullptr) return status;
  return WrongUsage(LongName(*words.repeated_flag) + " is given more than once", &verb);
}

// A value from the environment or the config file counts too.
absl::Status CheckRequired(const Verb& verb, const Settings& settings) {
  for (const Flag* flag : FlagsOf(verb)) {
    if (!flag->is_required || settings.contains(flag)) continue;
    return WrongUsage(absl::StrCat(verb.name, " needs ", flag->name, ": ", flag->text), &verb);
  }
  return absl::OkStatus();
}

// The last argument reads all further words, and those of a repeatable value together.
absl::Status ReadArguments(const Verb& verb, const std::vector<std::string>& words,
                           Options& options) {
  if (verb.passes_words_on) {
    options.words = words;
    return absl::OkStatus();
  }
  for (size_t i = 0; i < words.size(); ++i) {
    const Value& value = verb.arguments[std::min(i, verb.arguments.size() - 1)].value;
    std::string text = words[i];
    while (value.is_repeatable && i + 1 < words.size()) absl::StrAppend(&text, ",", words[++i]);
    absl::Status status = Named(value.name, value.read(text, options));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

// The page that the words without a verb ask for; empty if they do not.
std::string PageWithoutVerb(const std::vector<std::string>& words) {
  const std::string first = words.empty() ? "--help" : words[0];
  if (first == "--help" || first == "-h") return TextPage(nullptr);
  if (first == "--version") return absl::StrCat(kProgram, " ", BALLPISTON_VERSION, "\n");
  const bool is_alone = words.size() == 1 || words[1] == "--help" || words[1] == "-h";
  return is_alone ? GroupPage(first) : "";
}

// ---- the server's errors in the words of the command line: --rho, not spec.grid.rho[0] ----

constexpr absl::string_view kSpec = "spec.";

// --outgoing-epsilon for outgoing_epsilon[2].
std::string FlagNamed(absl::string_view field) {
  const absl::string_view last = field.substr(field.rfind('.') + 1);
  return absl::StrCat("--", absl::StrReplaceAll(last.substr(0, last.find('[')), {{"_", "-"}}));
}

// "points.csv, row 3 below the header" for grid.delta[2], and "points.csv, column delta" for
// grid.delta, unless a flag or the config file has set that list.
std::optional<std::string> PlaceInPoints(absl::string_view field, const Options& options) {
  if (options.points_file.empty() || !absl::ConsumePrefix(&field, "spec.grid.")) {
    return std::nullopt;
  }
  const v1::Grid& grid = options.spec.grid();
  const std::string name(field.substr(0, field.find('[')));
  const auto* list = v1::Grid::descriptor()->FindFieldByName(name);
  if (list == nullptr || grid.GetReflection()->FieldSize(grid, list) > 0) return std::nullopt;
  const std::string path = options.points_file == "-" ? "standard input" : options.points_file;
  size_t row = 0;
  const bool has_row =
      absl::ConsumeSuffix(&field, "]") && absl::SimpleAtoi(field.substr(field.find('[') + 1), &row);
  return has_row ? absl::StrCat(path, ", row ", row + 1, " below the header")
                 : absl::StrCat(path, ", column ", field);
}

std::string NameOfField(const std::string& field, const Verb& verb, const Options& options) {
  if (field == "spec.experiment") return "EXPERIMENT";
  if (const auto place = PlaceInPoints(field, options)) return *place;
  const std::string name = FlagNamed(field);
  const std::vector<const Flag*> flags = FlagsOf(verb);
  const bool is_flag = std::any_of(flags.begin(), flags.end(),
                                   [&name](const Flag* flag) { return LongName(*flag) == name; });
  return is_flag ? name : std::string(absl::StripPrefix(field, kSpec));
}

// The description of a field may name another one, or a model: permitted: target.samples.
std::string WithTargetFlags(const std::string& description) {
  std::vector<std::pair<std::string, std::string>> names = {
      {"closed_form", "closed-form"}, {"billiard_reference", "billiard-reference"}};
  for (const Flag& flag : TargetFlags().flags) {
    names.emplace_back("target." + KeyOf(flag), flag.name);
  }
  return absl::StrReplaceAll(description, names);
}

// The message of the error. A field that a flag of the verb sets has the flag's name. With --spec
// or --again a field of the specification has its path there: grid.rho[0].
std::string MessageWithFlags(const absl::Status& error, const Verb& verb, const Options& options) {
  const bool has_file = !options.spec_file.empty() || !options.again.empty();
  std::string message(error.message());
  const google::rpc::BadRequest request = ErrorViolations(error);
  for (const auto& violation : request.field_violations()) {
    const std::string& field = violation.field();
    const std::string& description = violation.description();
    const bool is_of_file = has_file && absl::StartsWith(field, kSpec);
    const std::string in_flags =
        is_of_file
            ? absl::StrCat(absl::StripPrefix(field, kSpec), ": ", description)
            : absl::StrCat(NameOfField(field, verb, options), ": ", WithTargetFlags(description));
    message = absl::StrReplaceAll(message, {{absl::StrCat(field, ": ", description), in_flags}});
  }
  return message;
}

}  // namespace

absl::StatusOr<CommandLine> ParseCommandLine(const std::vector<std::string>& words) {
  const Verb* const verb = VerbAt(words);
  if (verb == nullptr) {
    std::string page = PageWithoutVerb(words);
    if (page.empty()) return WrongUsage(NoSuchVerb(words), nullptr);
    return CommandLine{.page = std::move(page)};
  }
  const std::vector<std::string> rest(words.begin() + WordsIn(verb->name), words.end());
  const SortedWords sorted = SortWords(*verb, rest);
  const bool passes_help_on = verb->passes_words_on && rest.size() > 1;
  if (sorted.has_help && !passes_help_on) return CommandLine{.page = ShortPage(verb)};
  CommandLine line{.verb = verb};
  line.options.line = words;
  if (absl::Status bad = CheckWords(*verb, sorted); !bad.ok()) return bad;
  const absl::StatusOr<Settings> settings = ReadSettings(*verb, sorted);
  if (!settings.ok()) return settings.status();
  absl::Status status = CheckRequired(*verb, *settings);
  if (status.ok()) status = ReadArguments(*verb, sorted.arguments, line.options);
  if (status.ok()) status = ReadFlags(*verb, *settings, line.options);
  if (!status.ok()) return status;
  return line;
}

ExitCode RunCommandLine(const std::vector<std::string>& words, Terminal& terminal) {
  google::protobuf::SetLogHandler(nullptr);  // the program prints every error itself
  const absl::StatusOr<CommandLine> line = ParseCommandLine(words);
  if (line.ok()) {
    terminal.out << line->page;
    if (line->verb == nullptr) return ExitCode::kDone;
    terminal.verbosity = line->options.verbosity;
  }
  const VerbResult result = line.ok() ? line->verb->act(line->options, terminal) : line.status();
  if (result.ok()) return *result;
  const char* const prefix = terminal.colour ? "\x1b[1;31mballpiston:\x1b[0m " : "ballpiston: ";
  const std::string message = line.ok()
                                  ? MessageWithFlags(result.status(), *line->verb, line->options)
                                  : std::string(result.status().message());
  terminal.err << prefix << message << std::endl;
  return ExitCodeOf(result.status());
}

}  // namespace ballpiston::client
