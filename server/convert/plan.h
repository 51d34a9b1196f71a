// The ladder of models as a message of the API. Pure functions.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "core/model_choice/ladder.h"

namespace ballpiston::server {

v1::PointPlan PointPlanMessage(const PointParameters& point, const Ladder& ladder);

}  // namespace ballpiston::server
