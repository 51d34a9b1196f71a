// ballpiston web: becomes the program ballpiston-web, with the same words.
#include <errno.h>
#include <unistd.h>

#include "absl/status/status.h"
#include "client/command/verbs.h"
#include "client/library/child_process.h"

namespace ballpiston::client {
VerbResult Web(const Options& options, Terminal& terminal) {
  if (serve_page != nullptr) return serve_page(options, terminal);
  std::string program = ProgramBeside("ballpiston-web");
  std::vector<char*> arguments = {program.data()};
  for (const std::string& word : options.line) arguments.push_back(const_cast<char*>(word.data()));
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  const absl::Status why = absl::ErrnoToStatus(errno, "cannot start " + program);
  return absl::FailedPreconditionError(why.message());
}

}  // namespace ballpiston::client
