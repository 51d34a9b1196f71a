// The file of --config: lines FLAG = VALUE or FLAG = "VALUE", and comments, which begin with #.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace ballpiston::server {

// Adds --config, and the reader of its file. Errors name the file and the line.
void AddFlagFile(CLI::App& app);

// The error message for a flag that does not exist. `flag` is its name without dashes, `written` is
// what the user wrote.
std::string NoSuchFlag(const CLI::App& app, const std::string& flag, const std::string& written);

}  // namespace ballpiston::server
