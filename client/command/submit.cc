// ballpiston submit: hands a job to the server and prints its name, alone, on standard output; on
// standard error, if the answer was there already.
#include <CLI/CLI.hpp>
#include <memory>

#include "client/command/connection.h"
#include "client/command/create_job.h"
#include "client/command/spec_flags.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"

namespace ballpiston::client {
namespace {

struct Submit {
  SpecFlags spec;
  JobFlags flags;
  ServerFlag server;

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<v1::EnsembleSpec> wanted = SpecOf(spec);
    const absl::StatusOr<CreateOptions> options = OptionsOf(flags);
    const Violations violations({wanted.status(), options.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    return WithServer(server, [&](const Connection& connection) -> absl::StatusOr<ExitCode> {
      const auto job = CreateJob(connection, *wanted, *options);
      if (!job.ok()) return job.status();
      if (job->answered_from_store()) terminal.err << FromStoreText(*job) << std::endl;
      terminal.out << job->name() << '\n';
      return ExitCode::kDone;
    });
  }
};

}  // namespace

void AddSubmit(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("submit", "submit a job, print its name");
  const auto submit = std::make_shared<Submit>();
  submit->spec.AddTo(*verb);
  submit->flags.AddTo(*verb);
  submit->server.AddTo(*verb);
  verb->callback([&action, submit] { action = [submit](Terminal& t) { return submit->Act(t); }; });
}

}  // namespace ballpiston::client
