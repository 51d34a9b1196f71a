// ballpiston analytic: the closed forms at every pair of (rho, delta).
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "absl/strings/string_view.h"
#include "client/command/connection.h"
#include "client/command/flags.h"
#include "client/command/number_list.h"
#include "client/command/request_size.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/library/analytic_client.h"
#include "client/output/analytic_output.h"

namespace ballpiston::client {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

absl::Status Take(absl::string_view name, const std::optional<std::string>& text, Numbers* into) {
  if (!text) return absl::OkStatus();
  const absl::StatusOr<std::vector<double>> list = ParseNumberList(name, *text);
  if (list.ok()) into->Add(list->begin(), list->end());
  return list.status();
}

struct Analytic {
  std::optional<std::string> rho, delta, epsilon, outgoing_epsilon, beta, temperature;
  ServerFlag server;
  FormatFlag format;

  void AddTo(CLI::App& verb) {
    verb.add_option("--rho", rho, "disc radii (LIST: a,b,c or from:to:count or from:to:count:log)")
        ->required();
    verb.add_option("--delta", delta, "piston's penetrations (LIST)")->required();
    verb.add_option("--epsilon", epsilon, "piston's energies, 0 to 1/2 (LIST): rates and moments");
    verb.add_option("--outgoing-epsilon", outgoing_epsilon,
                    "outgoing energies (LIST): the kernel W; not in CSV");
    verb.add_option("--temperature", temperature,
                    "temperatures (LIST): canonical averages, exchange rate, static conductivity");
    verb.add_option("--beta", beta, "inverse temperatures (LIST): the same");
    server.AddTo(verb);
    format.AddTo(verb);
  }

  absl::StatusOr<v1::EvaluatePairsRequest> Request() const {
    v1::EvaluatePairsRequest request;
    absl::Status status =
        Violations(
            {Take("--rho", rho, request.mutable_rho()),
             Take("--delta", delta, request.mutable_delta()),
             Take("--epsilon", epsilon, request.mutable_epsilon()),
             Take("--outgoing-epsilon", outgoing_epsilon, request.mutable_outgoing_epsilon()),
             Take("--beta", beta, request.mutable_beta()),
             Take("--temperature", temperature, request.mutable_temperature())})
            .Lines();
    if (status.ok()) status = CheckSize(request, "");
    if (!status.ok()) return status;
    return request;
  }

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<v1::EvaluatePairsRequest> request = Request();
    const absl::StatusOr<Format> shape = ParseFormat(format.text);
    const Violations violations({request.status(), shape.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const AnalyticClient client(connection.channel);
      const auto response = connection.Ask([&] { return client.EvaluatePairs(*request); });
      if (!response.ok()) return response.status();
      const Numbers& outgoing = request->outgoing_epsilon();
      PrintAnalytics(*response, {outgoing.begin(), outgoing.end()}, *shape, terminal.out);
      return ExitCode::kDone;
    });
  }
};

}  // namespace

void AddAnalytic(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("analytic", "evaluate the closed forms");
  const auto analytic = std::make_shared<Analytic>();
  analytic->AddTo(*verb);
  verb->callback(
      [&action, analytic] { action = [analytic](Terminal& t) { return analytic->Act(t); }; });
}

}  // namespace ballpiston::client
