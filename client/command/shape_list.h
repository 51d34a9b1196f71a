// Lists of shapes of a gas, as users write them on the command line.
//
//   LIST   items separated by commas, each a SHAPE or a range; at most 100,000 shapes
//   SHAPE  N, a chain of N cells, or NxM, a lattice; N and M are COUNTs
//   range  FROM:TO:COUNT or FROM:TO:COUNT:log, whose numbers are whole: chains of these lengths
//
// COUNT and range are those of number_list.h. The server checks which numbers are permitted.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

// Returns each shape in its canonical form: 1e3x04 becomes 1000x4. Every error is INVALID_ARGUMENT;
// it quotes the text and states the permitted form.
absl::StatusOr<std::vector<std::string>> ParseShapeList(absl::string_view text);

absl::StatusOr<std::string> ParseShape(absl::string_view text);  // a single SHAPE

}  // namespace ballpiston::client
