// ballpiston delete: deletes ended jobs with their results. Prints the name of each deleted job.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/command/selection.h"

namespace ballpiston::client {

// A delete is not retried: if its answer was lost, a second attempt would find no such job.
VerbResult Delete(const Options& options, Terminal& terminal) {
  return WithJobs(options, terminal, kEndedStates, [&](const auto& connection, const auto& names) {
    absl::Status first_error = Confirm("delete", names, options, terminal);
    if (!first_error.ok()) return VerbResult(first_error);
    for (const std::string& name : names) {
      const absl::Status status = connection.client.Delete(name);
      if (status.ok()) terminal.out << name << " deleted" << std::endl;
      const bool is_open = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
      if (is_open) terminal.err << "ballpiston: " << name << " may have been deleted" << std::endl;
      first_error.Update(status);
    }
    return first_error.ok() ? VerbResult(ExitCode::kDone) : first_error;
  });
}

}  // namespace ballpiston::client
