// A table of points from a CSV file: a header with the names of parameters, in any order, then a
// row for each point. Cells may have quotes; empty lines do not count. --points reads it.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// Reads the table into the lists of the grid, and names them in its table. INVALID_ARGUMENT names
// the file, the line and the column of an error.
absl::Status ParsePoints(const std::string& name, absl::string_view csv, v1::Grid& grid);

}  // namespace ballpiston::client
