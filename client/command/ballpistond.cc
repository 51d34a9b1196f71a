#include "client/command/ballpistond.h"

#include <signal.h>

#include <utility>

#include "absl/strings/str_join.h"
#include "client/command/interrupts.h"
#include "client/library/child_process.h"
#include "client/library/server_process.h"

namespace ballpiston::client {

VerbResult RunBallpistond(std::vector<std::string> flags, const Terminal& terminal) {
  flags.insert(flags.begin(), UsualServerProgram());
  terminal.Detail(absl::StrJoin(flags, " "));
  const auto pid = StartChild({.command = std::move(flags), .folder = "", .output = ""});
  if (!pid.ok()) return absl::FailedPreconditionError(pid.status().message());
  const Interrupts::Scope scope(terminal.interrupts, [&] { kill(*pid, SIGTERM); });
  const absl::StatusOr<int> status = WaitForChild(*pid);
  if (!status.ok()) return status.status();
  return ExitCodeOf(*status);
}

}  // namespace ballpiston::client
