// ballpiston plan: what each model of the ladder would cost for a question, how well it would
// answer, and which one would be taken. Runs nothing.
#include <CLI/CLI.hpp>
#include <memory>

#include "client/command/connection.h"
#include "client/command/flags.h"
#include "client/command/spec_flags.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/library/ensemble_client.h"
#include "client/output/plan_output.h"

namespace ballpiston::client {
namespace {

struct Plan {
  SpecFlags spec;
  ServerFlag server;
  FormatFlag format;

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<v1::EnsembleSpec> wanted = SpecOf(spec);
    const absl::StatusOr<Format> shape = ParseFormat(format.text);
    const Violations violations({wanted.status(), shape.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const EnsembleClient client(connection.channel);
      const auto plan = connection.Ask([&] { return client.Plan(*wanted); });
      if (!plan.ok()) return plan.status();
      PrintPlan(*wanted, *plan, *shape, terminal.out);
      return ExitCode::kDone;
    });
  }
};

}  // namespace

void AddPlan(CLI::App& app, Action& action) {
  CLI::App* verb =
      app.add_subcommand("plan", "show what each model would cost and how well it would answer");
  const auto plan = std::make_shared<Plan>();
  plan->spec.AddTo(*verb);
  plan->server.AddTo(*verb);
  plan->format.AddTo(*verb);
  verb->callback([&action, plan] { action = [plan](Terminal& t) { return plan->Act(t); }; });
}

}  // namespace ballpiston::client
