// How --help is laid out, and its lines that describe no flag.
#pragma once

#include <CLI/CLI.hpp>

namespace ballpiston::server {

// Sets the layout, the description, the usage and the exit codes.
void SetHelpPage(CLI::App& app);

}  // namespace ballpiston::server
