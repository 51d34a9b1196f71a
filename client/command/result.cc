// ballpiston result: prints a job's finished points.
#include <CLI/CLI.hpp>
#include <memory>

#include "client/command/connection.h"
#include "client/command/flags.h"
#include "client/command/print_result.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"

namespace ballpiston::client {
namespace {

struct Result {
  JobArgument job;
  ServerFlag server;
  FormatFlag format;

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<std::string> name = job.Name();
    const absl::StatusOr<Format> shape = ParseFormat(format.text);
    const Violations violations({name.status(), shape.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithServer(server, [&](const Connection& connection) {
      return PrintResult(connection, *name, *shape, terminal);
    });
  }
};

}  // namespace

void AddResult(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("result", "print a job's result, or what it finished so far");
  const auto result = std::make_shared<Result>();
  result->job.AddTo(*verb);
  result->server.AddTo(*verb);
  result->format.AddTo(*verb);
  verb->callback([&action, result] { action = [result](Terminal& t) { return result->Act(t); }; });
}

}  // namespace ballpiston::client
