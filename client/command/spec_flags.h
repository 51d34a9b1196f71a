// An ensemble's specification from the command line: EXPERIMENT with grid and target flags, or
// --spec FILE with all of it as proto JSON.
//
// Only the form is checked here, what the text means and whether it can be run is the server's to
// say: it knows the physics, and reports every violation at once.
#ifndef BALLPISTON_CLIENT_COMMAND_SPEC_FLAGS_H_
#define BALLPISTON_CLIENT_COMMAND_SPEC_FLAGS_H_

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/v1/spec.pb.h"

namespace CLI {
class App;
}

namespace ballpiston::client {

// The flags' texts; absent if not given. Of the targets only a tolerance and a budget go together.
struct SpecFlags {
  std::optional<std::string> experiment;
  std::optional<std::string> rho, delta, epsilon, exponent, cells;
  std::optional<std::string> samples, collisions, tolerance, budget;
  std::optional<std::string> seed, model, precision;
  bool verify = false;
  std::optional<std::string> file;

  void AddTo(CLI::App& verb);
};

// INVALID_ARGUMENT has a line for every violation (violations.h), which names the flag, the text
// and what is permitted; or the file; or the field that is too large to be sent (request_size.h).
absl::StatusOr<v1::EnsembleSpec> SpecOf(const SpecFlags& flags);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_SPEC_FLAGS_H_
