// ballpiston run: submit, watch, and print the result.
#include <CLI/CLI.hpp>
#include <memory>

#include "client/command/connection.h"
#include "client/command/create_job.h"
#include "client/command/flags.h"
#include "client/command/follow_job.h"
#include "client/command/interrupts.h"
#include "client/command/print_result.h"
#include "client/command/spec_flags.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"

namespace ballpiston::client {
namespace {

struct Run {
  SpecFlags spec;
  JobFlags job;
  ServerFlag server;
  FormatFlag format;
  ProgressFlag progress;

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<v1::EnsembleSpec> wanted = SpecOf(spec);
    const absl::StatusOr<CreateOptions> options = OptionsOf(job);
    const absl::StatusOr<Format> shape = ParseFormat(format.text);
    const absl::StatusOr<ProgressStyle> style = ParseProgressStyle(progress.text);
    const Violations violations(
        {wanted.status(), options.status(), shape.status(), style.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    Interrupts interrupts;  // before gRPC starts threads
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const auto made = CreateJob(connection, *wanted, *options);
      if (!made.ok()) return made.status();
      if (made->answered_from_store() && progress.text != "none") {
        NewProgressReporter(*style, terminal.err)->Note(FromStoreText(*made));
      }
      return Finish(connection, *made, *shape, *style, interrupts, terminal);
    });
  }

  static absl::StatusOr<ExitCode> Finish(const Connection& connection, const v1::EnsembleJob& made,
                                         Format shape, ProgressStyle style, Interrupts& interrupts,
                                         Terminal& terminal) {
    const auto end = FollowJob(connection, made.name(), style, interrupts, terminal.err);
    if (!end.ok()) return end.status();
    if (!end->has_value()) return ExitCode::kInterrupted;
    return PrintResult(connection, made.name(), shape, terminal, made.answered_from_store());
  }
};

}  // namespace

void AddRun(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("run", "submit a job, watch it, print its result");
  const auto run = std::make_shared<Run>();
  run->spec.AddTo(*verb);
  run->job.AddTo(*verb);
  run->server.AddTo(*verb);
  run->format.AddTo(*verb);
  run->progress.AddTo(*verb);
  verb->callback([&action, run] { action = [run](Terminal& t) { return run->Act(t); }; });
}

}  // namespace ballpiston::client
