// ballpiston delete: deletes an ended job with its results. Prints nothing.
#include <CLI/CLI.hpp>
#include <memory>

#include "client/command/connection.h"
#include "client/command/flags.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/library/ensemble_client.h"

namespace ballpiston::client {
namespace {

struct Delete {
  JobArgument job;
  ServerFlag server;

  absl::StatusOr<ExitCode> Act(Terminal&) const {
    const absl::StatusOr<std::string> name = job.Name();
    const Violations violations({name.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const EnsembleClient client(connection.channel);
      const absl::Status status = connection.Ask([&] { return client.Delete(*name); });
      if (!status.ok()) return status;
      return ExitCode::kDone;
    });
  }
};

}  // namespace

void AddDelete(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("delete", "delete an ended job and its results");
  const auto deletion = std::make_shared<Delete>();
  deletion->job.AddTo(*verb);
  deletion->server.AddTo(*verb);
  verb->callback(
      [&action, deletion] { action = [deletion](Terminal& t) { return deletion->Act(t); }; });
}

}  // namespace ballpiston::client
