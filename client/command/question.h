// An ensemble's specification from the command line: EXPERIMENT with the flags of grid, target and
// method, or --spec FILE with the whole specification as proto JSON, or --again JOB with the
// specification of an earlier job.
//
// The client checks only the form. The server checks the values, and reports all violations
// together.
#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "ballpiston/v1/spec.pb.h"
#include "client/command/connection.h"
#include "client/command/options.h"
#include "client/command/terminal.h"

namespace ballpiston::client {

// INVALID_ARGUMENT if there is no experiment, if targets exclude each other, or if the file cannot
// be used. With --again the returned specification is empty: WithQuestion reads it from the server.
absl::StatusOr<v1::EnsembleSpec> SpecOf(const Options& options);

// The content of the file of --spec, which `name` names in messages. INVALID_ARGUMENT, with the
// parser's message, if the text is not JSON, or has a field that a specification does not have.
absl::StatusOr<v1::EnsembleSpec> ParseSpec(absl::string_view name, absl::string_view json);

using VerbOfQuestion = std::function<VerbResult(const Connection&, const Options& asked)>;

// Checks the command line, connects, and runs `verb` with the options, in which `spec` is complete:
// with --again it is that of the job, and so are the labels unless --label is given.
VerbResult WithQuestion(const Options& options, const Terminal& terminal,
                        const VerbOfQuestion& verb);

}  // namespace ballpiston::client
