// Numbers and lists of numbers as users write them on the command line.
//
//   NUMBER  plain decimal or scientific: 0.1, -2, 1e-5. No nan, inf, hexadecimal or blanks.
//   COUNT   a whole number; 1e6 is permitted
//   LIST    items separated by commas, each a NUMBER or a range; at most 100,000 numbers
//           LISTs of shapes of a gas have shapes in place of NUMBERs: N, a chain of N cells, or
//           NxM, a lattice. The numbers of their ranges are chains. The server checks the shapes.
//   range   FROM:TO:COUNT, evenly spaced, both ends included; with :log evenly in the logarithm
//           (both ends above 0). A range with COUNT 1 is FROM alone.
//
// Every error is INVALID_ARGUMENT; it quotes the text and states the permitted form.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

inline constexpr int64_t kMaxListLength = 100'000;

// INVALID_ARGUMENT: the quoted text, then the reason.
absl::Status NotPermitted(absl::string_view text, absl::string_view reason);

absl::StatusOr<double> ParseNumber(absl::string_view text);
absl::StatusOr<int64_t> ParseCount(absl::string_view text);
absl::StatusOr<uint64_t> ParseSeed(absl::string_view text);
absl::StatusOr<std::vector<double>> ParseNumberList(absl::string_view text);
// Writes a count out: 1e3 is 1000. Another shape stays as it is, such as 4x3.
std::string ShapeText(absl::string_view text);
// The list's ranges are written out, and its shapes as by ShapeText.
absl::StatusOr<std::vector<std::string>> ParseShapeList(absl::string_view text);

}  // namespace ballpiston::client
