// Commands that ballpistond itself executes, without starting a server.
#pragma once

#include <string>
#include <vector>

#include "client/command/terminal.h"
#include "client/command/verbs.h"

namespace ballpiston::client {

// Runs ballpistond with these flags and waits for its end. Its output is this program's output.
VerbResult RunBallpistond(std::vector<std::string> flags, const Terminal& terminal);

}  // namespace ballpiston::client
