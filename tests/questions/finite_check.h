// No number is NaN or infinite.
#pragma once

#include <google/protobuf/message.h>

#include "core/ensemble/point_summary.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kFiniteCheck[] = "finite";

Findings CheckFinite(const google::protobuf::Message& message);

// Before the server leaves out what is not finite.
Findings CheckFinite(const PointSummary& summary);

}  // namespace ballpiston::questions
