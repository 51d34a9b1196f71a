// ballpiston watch: shows a job's progress until it ends.
#include <CLI/CLI.hpp>
#include <memory>

#include "client/command/connection.h"
#include "client/command/flags.h"
#include "client/command/follow_job.h"
#include "client/command/interrupts.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"

namespace ballpiston::client {
namespace {

struct Watch {
  JobArgument job;
  ServerFlag server;
  ProgressFlag progress;

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<std::string> name = job.Name();
    const absl::StatusOr<ProgressStyle> style = ParseProgressStyle(progress.text);
    const Violations violations({name.status(), style.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    Interrupts interrupts;  // before gRPC starts threads
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const auto end = FollowJob(connection, *name, *style, interrupts, terminal.err);
      if (!end.ok()) return end.status();
      return end->has_value() ? ReportEnd(**end, terminal.err) : ExitCode::kInterrupted;
    });
  }
};

}  // namespace

void AddWatch(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("watch", "show a job's progress until it ends");
  const auto watch = std::make_shared<Watch>();
  watch->job.AddTo(*verb);
  watch->server.AddTo(*verb);
  watch->progress.AddTo(*verb);
  verb->callback([&action, watch] { action = [watch](Terminal& t) { return watch->Act(t); }; });
}

}  // namespace ballpiston::client
