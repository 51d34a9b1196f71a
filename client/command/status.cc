// ballpiston status: what the server is doing and what it permits. Starts none.
#include <CLI/CLI.hpp>
#include <memory>

#include "absl/time/clock.h"
#include "client/command/connection.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/library/quoted.h"
#include "client/library/server_client.h"
#include "client/output/format.h"
#include "client/output/status_output.h"

namespace ballpiston::client {
namespace {

struct Status {
  ServerFlag server;
  std::string format = "table";

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<Format> shape = ShapeOf(format);
    const Violations violations({shape.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithRunningServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const auto status = ServerClient(connection.channel).Status();
      if (!status.ok()) return status.status();
      PrintStatus(*status, absl::Now(), *shape, terminal.out);
      return ExitCode::kDone;
    });
  }

  static absl::StatusOr<Format> ShapeOf(const std::string& text) {
    if (text == "table") return Format::kTable;
    if (text == "json") return Format::kJson;
    return absl::InvalidArgumentError("--format: " + Quoted(text) + " is not one of table, json");
  }
};

}  // namespace

void AddStatus(CLI::App& app, Action& action) {
  CLI::App* verb =
      app.add_subcommand("status", "show what the server is doing and what it permits");
  const auto status = std::make_shared<Status>();
  status->server.AddTo(*verb);
  verb->add_option("--format", status->format, "table | json; table if not given");
  verb->callback([&action, status] { action = [status](Terminal& t) { return status->Act(t); }; });
}

}  // namespace ballpiston::client
