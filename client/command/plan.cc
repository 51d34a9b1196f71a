// ballpiston plan: prints the cost and the accuracy of each model for a specification, and the
// model that --model auto would choose. Runs nothing.
#include "client/command/connection.h"
#include "client/command/question.h"
#include "client/output/plan_output.h"

namespace ballpiston::client {

VerbResult Plan(const Options& options, Terminal& terminal) {
  return WithQuestion(
      options, terminal,
      [&](const Connection& connection, const v1::EnsembleSpec& spec) -> VerbResult {
        const auto plan = connection.Ask([&] { return connection.client.Plan(spec); });
        if (!plan.ok()) return plan.status();
        PrintPlan(spec, *plan, options.format, terminal.out);
        return ExitCode::kDone;
      });
}

}  // namespace ballpiston::client
