// Flags from the config file, in CLI11's form (TOML): FLAG = VALUE for every verb that has the
// flag, or below [VERB] for this verb alone ([server.start] for server start).
//
// CLI11's own config file would override the environment, and has no keys that hold for all verbs.
#ifndef BALLPISTON_CLIENT_COMMAND_CONFIG_FILE_H_
#define BALLPISTON_CLIENT_COMMAND_CONFIG_FILE_H_

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "client/command/verb_table.h"

namespace ballpiston::client {

// The value of a variable; empty if it is not set.
std::string FromEnvironment(const std::string& variable);

// The path of ~/.config/ballpiston/config.toml; empty if the file does not exist.
std::string UsualConfig();

// Calls `add` with each of the verb's flags in the file, those below [VERB] first. INVALID_ARGUMENT
// names the file and the mistake.
absl::Status ReadConfig(const std::string& path, const Verb& verb,
                        const std::function<void(const Flag&, const std::string& text)>& add);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_CONFIG_FILE_H_
