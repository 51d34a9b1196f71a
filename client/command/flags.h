// Flags and arguments that several verbs share.
#ifndef BALLPISTON_CLIENT_COMMAND_FLAGS_H_
#define BALLPISTON_CLIENT_COMMAND_FLAGS_H_

#include <string>

#include "absl/status/statusor.h"

namespace CLI {
class App;
}

namespace ballpiston::client {

struct FormatFlag {
  std::string text = "table";

  void AddTo(CLI::App& verb);
};

struct ProgressFlag {
  std::string text = "auto";

  void AddTo(CLI::App& verb);
};

// JOB: a job's name, ensembleJobs/ID, or its ID alone, which is 1 to 63 of a-z, 0-9 and hyphen.
struct JobArgument {
  std::string text;

  void AddTo(CLI::App& verb);
  absl::StatusOr<std::string> Name() const;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_FLAGS_H_
