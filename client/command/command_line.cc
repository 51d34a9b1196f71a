#include "client/command/command_line.h"

#include <google/protobuf/stubs/logging.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

constexpr char kDescription[] = "Rarely interacting billiards, simulated by a service.";
constexpr char kFooter[] =
    "Exit codes: 0 done, 2 usage or invalid argument, 3 server unreachable or busy, 4 job failed "
    "or "
    "cancelled,\n5 not found, 6 not permitted, 130 interrupted.";

void AddVerbs(CLI::App& app, Action& action) {
  AddAnalytic(app, action);
  AddPlan(app, action);
  AddRun(app, action);
  AddSubmit(app, action);
  AddWatch(app, action);
  AddResult(app, action);
  AddList(app, action);
  AddCancel(app, action);
  AddDelete(app, action);
  AddStatus(app, action);
  AddFigure(app, action);
}

// The verbs that --help shows.
std::string Verbs(const CLI::App& app) {
  const auto name = [](std::string* out, const CLI::App* verb) { out->append(verb->get_name()); };
  const auto offered = [](const CLI::App* verb) { return !verb->get_group().empty(); };
  return absl::StrJoin(app.get_subcommands(offered), ", ", name);
}

// Verbs that the command line's contract names and this version lacks: whatever follows them, the
// answer is the same. `app` has to outlive the action.
void AddLaterVerbs(CLI::App& app, Action& action) {
  for (const std::string name : {"trace"}) {
    CLI::App* verb = app.add_subcommand(name)->group("")->prefix_command();
    verb->set_help_flag();
    verb->callback([&app, &action, name] {
      action = [&app, name](Terminal&) -> absl::StatusOr<ExitCode> {
        return absl::InvalidArgumentError(
            absl::StrCat(name, " is not offered by this version; it offers ", Verbs(app)));
      };
    });
  }
}

// CLI11's own words where they are good ones.
std::string Explanation(const CLI::App& app, const CLI::Error& error) {
  const std::vector<std::string> left = app.remaining(true);
  const bool has_verb = !app.get_subcommands().empty();
  const bool is_flag = !left.empty() && absl::StartsWith(left[0], "-");
  if (!has_verb && left.empty()) return absl::StrCat("name a verb: ", Verbs(app));
  if (!has_verb && !is_flag)
    return absl::StrCat(Quoted(left[0]), " is not a verb; verbs are ", Verbs(app));
  if (!left.empty())
    return absl::StrCat("not expected: ", Shortened(absl::StrJoin(left, " "), kLongestMessage));
  return Shortened(error.what(), kLongestMessage);
}

std::string UsageError(const CLI::App* app, const CLI::Error& error) {
  return absl::StrCat("ballpiston: ", Explanation(*app, error), " (--help tells more)\n");
}

// The exit code if the command line alone settles the matter: a mistake, or --help.
std::optional<ExitCode> Parse(CLI::App& app, int argc, const char* const* argv,
                              Terminal& terminal) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error, terminal.out, terminal.err);
    return code == 0 ? ExitCode::kDone : ExitCode::kUsage;
  }
  return std::nullopt;
}

}  // namespace

ExitCode RunCommandLine(int argc, const char* const* argv, Terminal& terminal) {
  // Every error is told here, in the project's words.
  google::protobuf::SetLogHandler(nullptr);
  CLI::App app(kDescription, "ballpiston");
  Action action;
  app.require_subcommand(1);
  app.failure_message(UsageError);
  app.footer(kFooter);
  AddVerbs(app, action);
  AddLaterVerbs(app, action);
  if (const auto code = Parse(app, argc, argv, terminal)) return *code;
  const absl::StatusOr<ExitCode> code = action(terminal);
  if (code.ok()) return *code;
  terminal.err << "ballpiston: " << code.status().message() << std::endl;
  return ExitCodeOf(code.status());
}

}  // namespace ballpiston::client
