// ballpiston list: prints the server's jobs, the newest first.
#include <CLI/CLI.hpp>
#include <memory>

#include "client/command/connection.h"
#include "client/command/flags.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/library/ensemble_client.h"
#include "client/output/job_list.h"

namespace ballpiston::client {
namespace {

struct List {
  ServerFlag server;
  FormatFlag format;

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<Format> shape = ParseFormat(format.text);
    const Violations violations({shape.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const EnsembleClient client(connection.channel);
      const auto jobs = connection.Ask([&] { return client.List(); });
      if (!jobs.ok()) return jobs.status();
      PrintJobs(*jobs, *shape, terminal.out);
      return ExitCode::kDone;
    });
  }
};

}  // namespace

void AddList(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("list", "list the jobs, the newest first");
  const auto list = std::make_shared<List>();
  list->server.AddTo(*verb);
  list->format.AddTo(*verb);
  verb->callback([&action, list] { action = [list](Terminal& t) { return list->Act(t); }; });
}

}  // namespace ballpiston::client
