#include "client/command/command_line.h"

#include <google/protobuf/stubs/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/command/config_file.h"
#include "client/command/field_flags.h"
#include "client/command/reference.h"
#include "client/command/suggestion.h"
#include "client/library/quoted.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

absl::Status Named(const std::string& name, const absl::Status& status) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(name, ": ", status.message()));
}

// A verb and the CLI11 parser of its words.
struct ParsedVerb {
  CLI::App* app = nullptr;
  std::vector<CLI::Option*> arguments;
  std::map<const Flag*, CLI::Option*> flags;
};

// A verb of several words is a subcommand of a subcommand.
CLI::App* AppOf(CLI::App& program, const std::string& verb) {
  CLI::App* app = &program;
  for (const absl::string_view word : absl::StrSplit(verb, ' ')) {
    const auto there = app->get_subcommands(
        [word](const CLI::App* subcommand) { return subcommand->get_name() == word; });
    CLI::App* const next = there.empty() ? app->add_subcommand(std::string(word)) : there.front();
    app->require_subcommand(1);
    app = next;
  }
  return app;
}

ParsedVerb Add(CLI::App& program, const Verb& verb) {
  ParsedVerb parsed{.app = AppOf(program, verb.name), .arguments = {}, .flags = {}};
  for (const Argument& argument : verb.arguments) {
    CLI::Option* option = parsed.app->add_option(argument.value.name);
    if (argument.IsMany()) option->expected(CLI::detail::expected_max_vector_size);
    option->required(argument.IsRequired());
    parsed.arguments.push_back(option);
  }
  for (const Flag* flag : FlagsOf(verb)) {
    if (flag->name.empty()) continue;
    CLI::Option* const option = flag->value.IsSwitch() ? parsed.app->add_flag(flag->name)
                                                       : parsed.app->add_option(flag->name);
    if (flag->value.is_repeatable) option->take_all();
    parsed.flags[flag] = option;
  }
  return parsed;
}

// The value of a flag and its source. Sources are in the order of increasing priority.
enum class Source { kFile, kSection, kVariable, kCommandLine };
struct Setting {
  std::string text;
  Source source;
};
using Settings = std::map<const Flag*, Setting>;

// A switch that is off replaces nothing.
bool IsOff(const Flag& flag, const Setting& setting) {
  bool on = true;
  return flag.value.IsSwitch() && absl::SimpleAtob(setting.text, &on) && !on;
}

bool IsReplaced(const Flag& flag, const Settings& stronger) {
  return std::any_of(stronger.begin(), stronger.end(), [&](const auto& other) {
    return Replaces(*other.first, flag) && !IsOff(*other.first, other.second);
  });
}

// Without the settings that others from stronger sources replace.
Settings WithoutReplaced(const Settings& settings) {
  Settings kept;
  for (const Source source :
       {Source::kCommandLine, Source::kVariable, Source::kSection, Source::kFile}) {
    Settings of_source;
    for (const auto& [flag, setting] : settings) {
      const bool is_here = setting.source == source;
      if (is_here && !IsReplaced(*flag, kept)) of_source.emplace(flag, setting);
    }
    kept.merge(of_source);
  }
  return kept;
}

void AddVariables(const Verb& verb, Settings& settings) {
  for (const Flag* flag : FlagsOf(verb)) {
    std::string text = FromEnvironment(flag->variable);
    if (!text.empty()) settings.try_emplace(flag, Setting{std::move(text), Source::kVariable});
  }
}

bool IsChoice(const Flag& flag, const std::string& text) {
  const std::vector<std::string>& choices = flag.value.choices;
  return std::find(choices.begin(), choices.end(), SpellingOfName(text)) != choices.end();
}

// A line for all verbs may name a choice that only some of them have, such as format = "csv".
bool IsForOtherVerbs(const Flag& flag, const std::string& text) {
  if (flag.value.choices.empty() || IsChoice(flag, text)) return false;
  return std::any_of(Verbs().begin(), Verbs().end(), [&](const Verb& verb) {
    const std::vector<const Flag*> flags = FlagsOf(verb);
    return std::any_of(flags.begin(), flags.end(), [&](const Flag* other) {
      return LongName(*other) == LongName(flag) && IsChoice(*other, text);
    });
  });
}

absl::Status AddConfig(const Verb& verb, Settings& settings) {
  std::string path = UsualConfig();
  for (const auto& [flag, setting] : settings) {
    if (LongName(*flag) == "--config") path = setting.text;
  }
  if (path.empty() || verb.act == &Help) return absl::OkStatus();
  return ReadConfig(path, verb,
                    [&](const Flag& flag, const std::string& text, bool is_for_this_verb) {
                      if (!is_for_this_verb && IsForOtherVerbs(flag, text)) return;
                      const Source source = is_for_this_verb ? Source::kSection : Source::kFile;
                      settings.try_emplace(&flag, Setting{text, source});
                    });
}

class WordParser {
 public:
  WordParser() : program_("", kProgram) {
    program_.set_version_flag("--version", absl::StrCat(kProgram, " ", BALLPISTON_VERSION));
    for (const Verb& verb : Verbs()) parsed_[&verb] = Add(program_, verb);
  }

  absl::StatusOr<CommandLine> Parse(const std::vector<std::string>& words) {
    if (words.empty()) return CommandLine{.page = TextPage(nullptr)};
    if (words.size() == 1) {
      if (std::string page = GroupPage(words[0]); !page.empty()) {
        return CommandLine{.page = std::move(page)};
      }
    }
    if (absl::Status bad = CheckValuesAreThere(words); !bad.ok()) return bad;
    first_word_ = words.front();
    try {
      program_.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::CallForHelp&) {
      const bool is_group = Chosen() == nullptr && &Innermost() != &program_;
      return CommandLine{.page =
                             is_group ? GroupPage(Innermost().get_name()) : ShortPage(Chosen())};
    } catch (const CLI::CallForVersion& version) {
      return CommandLine{.page = absl::StrCat(version.what(), "\n")};
    } catch (const CLI::ParseError& error) {
      return absl::InvalidArgumentError(Explanation(error));
    }
    CommandLine line{.verb = Chosen()};
    Settings settings = OnTheCommandLine(*line.verb);
    AddVariables(*line.verb, settings);
    absl::Status status = AddConfig(*line.verb, settings);
    if (status.ok()) status = ReadArguments(*line.verb, line.options);
    if (status.ok()) status = ReadFlags(*line.verb, WithoutReplaced(settings), line.options);
    if (!status.ok()) return status;
    return line;
  }

 private:
  const Verb* Chosen() const {
    for (const auto& [verb, parsed] : parsed_) {
      if (parsed.app->parsed()) return verb;
    }
    return nullptr;
  }

  // If the value is missing, CLI11 would take the next word as the value, even if it is a flag.
  static absl::Status CheckValuesAreThere(const std::vector<std::string>& words) {
    const std::string line = absl::StrCat(absl::StrJoin(words, " "), " ");
    std::map<std::string, bool> takes_value;
    for (const Verb& verb : Verbs()) {
      if (!absl::StartsWith(line, verb.name + " ")) continue;
      for (const Flag* flag : FlagsOf(verb)) {
        takes_value[LongName(*flag)] = !flag->value.IsSwitch();
      }
    }
    for (auto word = words.begin(); word != words.end() && *word != "--"; ++word) {
      const std::string name = word->substr(0, word->find('='));
      const auto flag = takes_value.find(name);
      if (flag == takes_value.end() || !flag->second) continue;
      const bool is_empty = *word == name + "=";
      const bool is_next_a_flag =
          *word == name && word + 1 != words.end() &&
          takes_value.contains((word + 1)->substr(0, (word + 1)->find('=')));
      if (is_empty || is_next_a_flag) {
        return absl::InvalidArgumentError(absl::StrCat(name, " needs a value"));
      }
    }
    return absl::OkStatus();
  }

  Settings OnTheCommandLine(const Verb& verb) const {
    Settings settings;
    for (const auto& [flag, option] : parsed_.at(&verb).flags) {
      if (option->empty()) continue;
      settings[flag] = {absl::StrJoin(option->results(), ","), Source::kCommandLine};
    }
    return settings;
  }

  absl::Status ReadArguments(const Verb& verb, Options& options) const {
    for (size_t i = 0; i < verb.arguments.size(); ++i) {
      for (const std::string& text : parsed_.at(&verb).arguments[i]->results()) {
        const Value& value = verb.arguments[i].value;
        absl::Status status = Named(value.name, value.read(text, options));
        if (!status.ok()) return status;
      }
    }
    return absl::OkStatus();
  }

  // In the order of the table. An empty variable counts as not set.
  static absl::Status ReadFlags(const Verb& verb, const Settings& settings, Options& options) {
    for (const Flag* flag : FlagsOf(verb)) {
      if (!flag->variable.empty()) options.inherited[flag->variable] = "";
      const auto setting = settings.find(flag);
      if (setting == settings.end()) continue;
      if (absl::Status bad = ReadFlag(*flag, setting->second, options); !bad.ok()) return bad;
    }
    return absl::OkStatus();
  }

  static absl::Status ReadFlag(const Flag& flag, const Setting& setting, Options& options) {
    const std::string name = LongName(flag);
    if (!flag.variable.empty())
      options.inherited[flag.variable] = Absolute(flag.value, setting.text);
    if (setting.source == Source::kCommandLine) {
      options.given.insert(name);
      if (IsOfConnection(flag)) {
        absl::StrAppend(&options.connection, " ", name,
                        flag.value.IsSwitch() ? "" : " " + ShellWord(setting.text));
      }
    }
    return Named(NameOf(flag, setting.source), flag.value.read(setting.text, options));
  }

  // Whether another command needs this flag to reach the same server.
  static bool IsOfConnection(const Flag& flag) {
    const auto& flags = ServerFlags().flags;
    return LongName(flag) == "--config" ||
           std::any_of(flags.begin(), flags.end(),
                       [&flag](const Flag& other) { return &other == &flag; });
  }

  static std::string NameOf(const Flag& flag, Source source) {
    if (source == Source::kCommandLine) return LongName(flag);
    if (source == Source::kVariable) return flag.variable;
    return KeyOf(flag) + " of the config file";
  }

  // An absolute path, for a program that runs in another folder.
  static std::string Absolute(const Value& value, const std::string& text) {
    std::error_code error;
    absl::string_view path = text;
    if (absl::ConsumePrefix(&path, "unix:")) {
      return "unix:" + std::filesystem::absolute(std::string(path), error).string();
    }
    return value.offer == Offer::kFile ? std::filesystem::absolute(text, error).string() : text;
  }

  // The text, quoted if needed, so that a shell reads it as one word.
  static std::string ShellWord(const std::string& text) {
    constexpr char kPlain[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=@%+,-[]";
    if (text.find_first_not_of(kPlain) == std::string::npos) return text;
    return absl::StrCat("'", absl::StrReplaceAll(text, {{"'", "'\\''"}}), "'");
  }

  static std::vector<std::string> Names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(verb->get_name());
    }
    return names;
  }

  // CLI11's parser of the verb in which the error is, or of the program if there is no verb.
  const CLI::App& Innermost() const {
    const CLI::App* app = &program_;
    while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
    return *app;
  }

  std::string Explanation(const CLI::ParseError& error) const {
    const CLI::App& app = Innermost();
    const Verb* verb = Chosen();
    std::vector<std::string> left = program_.remaining(true);
    left.erase(std::remove(left.begin(), left.end(), "--"), left.end());
    const std::string more =
        absl::StrCat(" (", kProgram, " help", verb == nullptr ? "" : absl::StrCat(" ", verb->name),
                     " shows its usage)");
    if (verb == nullptr && left.empty()) {
      return absl::StrCat("no verb is given; verbs are ", absl::StrJoin(Names(app), ", "), more);
    }
    if (!left.empty()) return absl::StrCat(Unexpected(app, verb, left.front()), more);
    return absl::StrCat(Missing(verb, error), more);
  }

  std::string Unexpected(const CLI::App& app, const Verb* verb, const std::string& word) const {
    if (absl::StartsWith(word, "-")) return NoSuchFlag(verb, word.substr(0, word.find('=')));
    // After an unknown first word CLI11 still finds a verb among the later words.
    const std::vector<std::string> verbs = Names(program_);
    const bool is_first =
        word == first_word_ && std::find(verbs.begin(), verbs.end(), word) == verbs.end();
    if (verb != nullptr && !is_first) return absl::StrCat("not expected: ", Quoted(word));
    const std::vector<std::string> names = is_first ? verbs : Names(app);
    return absl::StrCat(Quoted(word), " is not a verb; verbs are ", absl::StrJoin(names, ", "),
                        DidYouMean(word, names));
  }

  static std::string NoSuchFlag(const Verb* verb, const std::string& name) {
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

  std::string Missing(const Verb* verb, const CLI::ParseError& error) const {
    const ParsedVerb& parsed = parsed_.at(verb);
    for (size_t i = 0; i < verb->arguments.size(); ++i) {
      const Argument& argument = verb->arguments[i];
      if (parsed.arguments[i]->get_required() && parsed.arguments[i]->count() == 0) {
        return absl::StrCat(verb->name, " needs ", argument.value.name, ": ", argument.text);
      }
    }
    for (const auto& [flag, option] : parsed.flags) {
      if (option->count() > 1) return absl::StrCat(LongName(*flag), " is given more than once");
    }
    const std::string text = error.what();  // --rho: 1 required LIST missing
    return absl::StrCat(Shortened(text.substr(0, text.find(':')), kLongestMessage),
                        " needs a value");
  }

  CLI::App program_;
  std::string first_word_;
  std::map<const Verb*, ParsedVerb> parsed_;
};

Verbosity VerbosityOf(const Options& options) {
  if (options.quiet) return Verbosity::kQuiet;
  return options.verbose ? Verbosity::kVerbose : Verbosity::kNormal;
}

VerbResult Act(const CommandLine& line, Terminal& terminal) {
  terminal.out << line.page;
  if (line.verb == nullptr) return ExitCode::kDone;
  terminal.verbosity = VerbosityOf(line.options);
  return line.verb->act(line.options, terminal);
}

std::string MessageOf(const absl::Status& error, const absl::StatusOr<CommandLine>& line) {
  if (!line.ok()) return std::string(error.message());
  return MessageWithFlags(error, *line->verb, line->options);
}

}  // namespace

absl::StatusOr<CommandLine> ParseCommandLine(const std::vector<std::string>& words) {
  return WordParser().Parse(words);
}

ExitCode RunCommandLine(const std::vector<std::string>& words, Terminal& terminal) {
  google::protobuf::SetLogHandler(nullptr);  // the program prints every error itself
  const absl::StatusOr<CommandLine> line = ParseCommandLine(words);
  const VerbResult result = line.ok() ? Act(*line, terminal) : line.status();
  if (result.ok()) return *result;
  const char* const prefix = terminal.colour ? "\x1b[1;31mballpiston:\x1b[0m " : "ballpiston: ";
  terminal.err << prefix << MessageOf(result.status(), line) << std::endl;
  return ExitCodeOf(result.status());
}

}  // namespace ballpiston::client
