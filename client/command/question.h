// An ensemble's specification from the command line: EXPERIMENT with the flags of grid, target and
// method, or --spec FILE with all of it as proto JSON, or --again JOB with the specification of an
// earlier job.
//
// Only the form is checked here. The server knows the physics: it checks the values, and reports
// every violation at once.
#ifndef BALLPISTON_CLIENT_COMMAND_QUESTION_H_
#define BALLPISTON_CLIENT_COMMAND_QUESTION_H_

#include <functional>

#include "absl/status/statusor.h"
#include "ballpiston/v1/spec.pb.h"
#include "client/command/connection.h"
#include "client/command/options.h"
#include "client/command/terminal.h"

namespace ballpiston::client {

// INVALID_ARGUMENT if there is no experiment, if targets exclude each other, or if the file cannot
// be used. With --again the specification is empty, because the server has it.
absl::StatusOr<v1::EnsembleSpec> SpecOf(const Options& options);

using VerbOfQuestion = std::function<VerbResult(const Connection&, const v1::EnsembleSpec&)>;

// Connects and runs `verb` with the specification; with --again it is read from the job. The
// command line is checked before any call.
VerbResult WithQuestion(const Options& options, const Terminal& terminal,
                        const VerbOfQuestion& verb);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_QUESTION_H_
