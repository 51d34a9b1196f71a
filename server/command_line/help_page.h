// How --help is laid out, and its lines that describe no flag.
#ifndef BALLPISTON_SERVER_COMMAND_LINE_HELP_PAGE_H_
#define BALLPISTON_SERVER_COMMAND_LINE_HELP_PAGE_H_

#include <CLI/CLI.hpp>

namespace ballpiston::server {

// Sets the layout, the description, the usage and the exit codes.
void SetHelpPage(CLI::App& app);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_COMMAND_LINE_HELP_PAGE_H_
