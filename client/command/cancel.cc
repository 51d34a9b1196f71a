// ballpiston cancel: stops jobs; the points that they finished stay. Prints each job's name and
// state.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/command/selection.h"
#include "client/library/request_id.h"
#include "client/output/spelling.h"

namespace ballpiston::client {

VerbResult Cancel(const Options& options, Terminal& terminal) {
  return WithJobs(options, terminal, kActiveStates, [&](const auto& connection, const auto& names) {
    absl::Status first_error = Confirm("cancel", names, options, terminal);
    if (!first_error.ok()) return VerbResult(first_error);
    for (const std::string& name : names) {
      const std::string id = NewRequestId();  // the same for a retry
      const auto job = connection.Ask([&] { return connection.client.Cancel(name, id); });
      first_error.Update(job.status());
      if (!job.ok()) continue;
      terminal.out << job->name() << ' ' << Spelling(job->state()) << std::endl;
      terminal.Note(absl::StrCat(name, ": ", job->progress().points_done(), " of ",
                                 job->progress().points(), " points are finished and stay"));
    }
    return first_error.ok() ? VerbResult(ExitCode::kDone) : first_error;
  });
}

}  // namespace ballpiston::client
