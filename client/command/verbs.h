// The program's verbs. Each function adds one to the command line; parsing stores what the chosen
// one will do, and nothing is done before the whole command line was found to be right.
#ifndef BALLPISTON_CLIENT_COMMAND_VERBS_H_
#define BALLPISTON_CLIENT_COMMAND_VERBS_H_

#include <functional>
#include <ostream>
#include <string>

#include "absl/status/statusor.h"
#include "client/command/exit_code.h"

namespace CLI {
class App;
}

namespace ballpiston::client {

struct Terminal {
  std::ostream& out;  // results only
  std::ostream& err;  // progress, notes, errors
};

using Action = std::function<absl::StatusOr<ExitCode>(Terminal&)>;

void AddAnalytic(CLI::App& app, Action& action);
void AddPlan(CLI::App& app, Action& action);
void AddRun(CLI::App& app, Action& action);
void AddSubmit(CLI::App& app, Action& action);
void AddWatch(CLI::App& app, Action& action);
void AddResult(CLI::App& app, Action& action);
void AddList(CLI::App& app, Action& action);
void AddCancel(CLI::App& app, Action& action);
void AddDelete(CLI::App& app, Action& action);
void AddStatus(CLI::App& app, Action& action);
void AddFigure(CLI::App& app, Action& action);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_VERBS_H_
