// Where a finished point ended, as compressed bytes: another job can continue it from there. Pure
// functions.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/ensemble/point_fold.h"

namespace ballpiston::server {

std::string EndBytes(const FoldState& state);
absl::StatusOr<FoldState> EndFromBytes(const std::string& bytes);  // DATA_LOSS

}  // namespace ballpiston::server
