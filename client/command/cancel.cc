// ballpiston cancel: stops jobs; the points that they finished stay. Prints each job's name and
// state.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/library/request_id.h"
#include "client/output/spelling.h"

namespace ballpiston::client {

VerbResult Cancel(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    absl::Status first_error;
    for (const std::string& name : options.jobs) {
      const std::string id = NewRequestId();  // the same for a retry
      const auto job = connection.Ask([&] { return connection.client.Cancel(name, id); });
      first_error.Update(job.status());
      if (!job.ok()) continue;
      terminal.out << job->name() << ' ' << Spelling(job->state()) << std::endl;
      terminal.Note(absl::StrCat(name, ": ", job->progress().points_done(), " of ",
                                 job->progress().points(), " points are finished and stay"));
    }
    if (!first_error.ok()) return first_error;
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
