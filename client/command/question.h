// An ensemble's specification from the command line: EXPERIMENT with the flags of grid, target and
// method, or --spec FILE with all of it as proto JSON.
//
// Only the form is checked here. The server knows the physics: it checks the values, and reports
// every violation at once.
#ifndef BALLPISTON_CLIENT_COMMAND_QUESTION_H_
#define BALLPISTON_CLIENT_COMMAND_QUESTION_H_

#include "absl/status/statusor.h"
#include "ballpiston/v1/spec.pb.h"
#include "client/command/options.h"

namespace ballpiston::client {

// INVALID_ARGUMENT if there is no experiment, if targets exclude each other, or if the file cannot
// be used.
absl::StatusOr<v1::EnsembleSpec> SpecOf(const Options& options);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_QUESTION_H_
