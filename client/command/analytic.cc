// ballpiston analytic: evaluates the closed forms for every pair of rho and delta.
#include "client/command/connection.h"
#include "client/output/analytic_output.h"

namespace ballpiston::client {

VerbResult Analytic(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto response =
        connection.Ask([&] { return connection.client.EvaluatePairs(options.closed_forms); });
    if (!response.ok()) return response.status();
    const auto& outgoing = options.closed_forms.outgoing_epsilon();
    PrintAnalytics(*response, {outgoing.begin(), outgoing.end()}, options.format, terminal.out);
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
