// Fetches a job's finished points and prints them.
#ifndef BALLPISTON_CLIENT_COMMAND_PRINT_RESULT_H_
#define BALLPISTON_CLIENT_COMMAND_PRINT_RESULT_H_

#include <string>

#include "client/command/connection.h"
#include "client/command/terminal.h"
#include "client/output/format.h"

namespace ballpiston::client {

// kFailed for a job that failed or was cancelled; what it finished is printed all the same.
// `answered_from_store`: Create said so, which the server does not remember.
VerbResult PrintResult(const Connection& connection, const std::string& name, Format format,
                       Terminal& terminal, bool answered_from_store = false);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_PRINT_RESULT_H_
