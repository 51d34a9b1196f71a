// The functions of the verbs. The parser has already checked the command line.
//
//   one_answer.cc    analytic, plan, list, trace, server address, server status: one call each
//   run.cc           run, submit, result
//   reference.cc     help
//   python.cc        figure, export
//   change_jobs.cc   cancel, delete, pin, label
//   server.cc        the other verbs of `server`
//
// Every other verb has a file of its name.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/exit_code.h"
#include "client/command/options.h"
#include "client/command/terminal.h"

namespace ballpiston::client {

using VerbResult = absl::StatusOr<ExitCode>;

using VerbFunction = VerbResult(const Options& options, Terminal& terminal);

VerbFunction Analytic, Plan;
VerbFunction Run, Submit, Watch, Result, ListJobs, Cancel, Pin, Label, Delete;
VerbFunction Trace, Sample, Figure, Export, ReportJobs, Web;
VerbFunction ServerStart, ServerStop, ServerAddress, ServerStatus, ServerToken, ServerBackup,
    ServerCheck;
VerbFunction Help, Complete;

// The function that Web calls in ballpiston-web (web/web_server.cc). In ballpiston the pointer is
// null, and Web starts ballpiston-web.
inline VerbFunction* serve_page = nullptr;

// The names of the installed figures.
std::vector<std::string> FigureNames();

}  // namespace ballpiston::client
