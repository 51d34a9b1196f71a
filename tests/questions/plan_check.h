// A plan has samples and an end.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kPlanCheck[] = "plan";

// Thirty thousand years of a processor. A question that takes longer has to be refused.
inline constexpr double kMostPlannedSeconds = 1e12;

// The plan of a point, by all models. The model that would answer has a number of samples and a
// finite time; no number of any model is negative, NaN or infinite.
Findings CheckPlan(const v1::PointPlan& plan);

// The row of the model that would answer; null if there is none.
const v1::ModelPlan* Chosen(const v1::PointPlan& plan);

}  // namespace ballpiston::questions
