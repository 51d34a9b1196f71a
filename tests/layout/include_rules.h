// Rules for the includes of each folder of the project.
//
//   core:    arithmetic <- geometry <- closed_form, sampling <- billiard, markov <- experiment <-
//            model_choice; statistics knows no physics. Libraries: Eigen, Highway, Random123,
//            Boost's quadrature, Abseil and C++'s own, without threads and clocks.
//   server:  core and the protos.   client: the protos only.   Neither knows the other. Flags are
//            parsed by CLI11, which is slow to compile: in the server only command_line/ has it.
//   tools:   the core, and tools/flows, which has numbers of more bits from Boost. Only their tests
//            know them.
//   server/convert alone includes the core's physics and the API's messages in one file.
//   tests:   of a layer know that layer, and tests/support.
//
// A new folder needs a row in the table of include_rules.cc: a file of a folder without a row is a
// violation.
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
