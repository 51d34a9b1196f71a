// ballpiston cancel: stops a job; the points it finished stay. Prints the job's name and state.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "client/command/connection.h"
#include "client/command/flags.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/library/ensemble_client.h"
#include "client/library/request_id.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

struct Cancel {
  JobArgument job;
  ServerFlag server;

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<std::string> name = job.Name();
    const Violations violations({name.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const EnsembleClient client(connection.channel);
      const std::string id = NewRequestId();  // one for both attempts
      const auto cancelled = connection.Ask([&] { return client.Cancel(*name, id); });
      if (!cancelled.ok()) return cancelled.status();
      terminal.out << cancelled->name() << ' ' << Spelling(cancelled->state()) << '\n';
      return ExitCode::kDone;
    });
  }
};

}  // namespace

void AddCancel(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("cancel", "stop a job; what it finished stays");
  const auto cancel = std::make_shared<Cancel>();
  cancel->job.AddTo(*verb);
  cancel->server.AddTo(*verb);
  verb->callback([&action, cancel] { action = [cancel](Terminal& t) { return cancel->Act(t); }; });
}

}  // namespace ballpiston::client
