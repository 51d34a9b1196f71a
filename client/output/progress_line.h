// The text of the progress bar's one line.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "ballpiston/v1/result.pb.h"
#include "client/output/progress_meter.h"

namespace ballpiston::client {

// At most `width` characters. If the text is too long, its last parts are left out. The bar fills
// the rest of the line.
//   [######--------] 12/177 points  1.2e6 samples/s  0:35 left  tau_conditional 21.63 +- 0.12
std::string ProgressLine(const ProgressMeter& meter,
                         const std::optional<v1::PointResult>& point_in_work, size_t width);

}  // namespace ballpiston::client
