// ballpiston delete: deletes ended jobs with their results. Prints the name of each deleted job.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"

namespace ballpiston::client {

// A delete is not retried: if its answer was lost, a second attempt would find no such job.
VerbResult Delete(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    absl::Status first_error;
    for (const std::string& name : options.jobs) {
      const absl::Status status = connection.client.Delete(name);
      if (status.ok()) terminal.out << name << " deleted" << std::endl;
      const bool is_open = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
      if (is_open) terminal.err << "ballpiston: " << name << " may have been deleted" << std::endl;
      first_error.Update(status);
    }
    if (!first_error.ok()) return first_error;
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
