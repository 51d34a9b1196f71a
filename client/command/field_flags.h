// The server's errors in the words of the command line: --rho, not spec.grid.rho[0].
#pragma once

#include <string>

#include "absl/status/status.h"
#include "client/command/options.h"
#include "client/command/verb_table.h"

namespace ballpiston::client {

// The message of the error. A field that a flag of the verb sets has the flag's name. With --spec
// or --again a field of the specification has its path there: grid.rho[0].
std::string MessageWithFlags(const absl::Status& error, const Verb& verb, const Options& options);

}  // namespace ballpiston::client
