// Flags from the config file, in CLI11's form (TOML). FLAG = VALUE applies to every verb that has
// the flag; below [VERB] it applies only to that verb ([server.start] for server start).
//
// CLI11's own config file is not used: it would override the environment, and has no keys for all
// verbs.
#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "client/command/verb_table.h"

namespace ballpiston::client {

// The value of a variable; empty if it is not set.
std::string FromEnvironment(const std::string& variable);

// The path of ~/.config/ballpiston/config.toml; empty if the file does not exist.
std::string UsualConfig();

using AddSetting =
    std::function<void(const Flag& flag, const std::string& text, bool is_for_this_verb)>;

// Calls `add` with each of the verb's flags in the file, first with those below [VERB], which are
// for this verb only. INVALID_ARGUMENT names the file and the error, such as a key that is given
// twice.
absl::Status ReadConfig(const std::string& path, const Verb& verb, const AddSetting& add);

}  // namespace ballpiston::client
