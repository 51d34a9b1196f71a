// The functions of the verbs. Each function is in the file with the verb's name; the verbs of
// `server` are in server.cc. The parser has already checked the command line.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/exit_code.h"
#include "client/command/options.h"
#include "client/command/terminal.h"

namespace ballpiston::client {

using VerbResult = absl::StatusOr<ExitCode>;

VerbResult Analytic(const Options& options, Terminal& terminal);
VerbResult Plan(const Options& options, Terminal& terminal);
VerbResult Run(const Options& options, Terminal& terminal);
VerbResult Submit(const Options& options, Terminal& terminal);
VerbResult Watch(const Options& options, Terminal& terminal);
VerbResult Result(const Options& options, Terminal& terminal);
VerbResult ListJobs(const Options& options, Terminal& terminal);
VerbResult Cancel(const Options& options, Terminal& terminal);
VerbResult Pin(const Options& options, Terminal& terminal);
VerbResult Label(const Options& options, Terminal& terminal);
VerbResult Delete(const Options& options, Terminal& terminal);
VerbResult Trace(const Options& options, Terminal& terminal);
VerbResult Export(const Options& options, Terminal& terminal);
VerbResult Sample(const Options& options, Terminal& terminal);
VerbResult Figure(const Options& options, Terminal& terminal);
VerbResult ReportJobs(const Options& options, Terminal& terminal);
VerbResult Web(const Options& options, Terminal& terminal);
VerbResult ServerStart(const Options& options, Terminal& terminal);
VerbResult ServerStop(const Options& options, Terminal& terminal);
VerbResult ServerAddress(const Options& options, Terminal& terminal);
VerbResult ServerStatus(const Options& options, Terminal& terminal);
VerbResult ServerToken(const Options& options, Terminal& terminal);
VerbResult ServerBackup(const Options& options, Terminal& terminal);
VerbResult ServerCheck(const Options& options, Terminal& terminal);
VerbResult Help(const Options& options, Terminal& terminal);
VerbResult Complete(const Options& options, Terminal& terminal);

// The names of the installed figures.
std::vector<std::string> FigureNames();

}  // namespace ballpiston::client
