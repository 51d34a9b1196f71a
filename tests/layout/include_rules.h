// Rules for the includes of each folder of the project: include_rules.txt.
//
//   core:    arithmetic <- geometry <- closed_form, sampling <- billiard, markov <- experiment <-
//            model_choice; statistics knows no physics.
//   server:  core and the protos.   client: the protos only.   Neither knows the other.
//   tools:   the core, and tools/flows. Only their tests know them.
//   server/convert alone includes the core's physics and the API's messages in one file.
//   tests:   of a layer know that layer, and tests/support.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ballpiston {

// The included files, in order, without quotes or angle brackets.
std::vector<std::string> IncludesOf(std::string_view text);

// One sentence for each include that is not permitted. `path` is relative to the
// repository's root.
std::vector<std::string> WrongIncludes(std::string_view path, std::string_view text);

}  // namespace ballpiston
