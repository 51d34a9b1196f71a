// The ladder of models as a message of the API. Pure functions.
#ifndef BALLPISTON_SERVER_CONVERT_PLAN_H_
#define BALLPISTON_SERVER_CONVERT_PLAN_H_

#include "ballpiston/v1/ensemble.pb.h"
#include "core/model_choice/ladder.h"

namespace ballpiston::server {

v1::PointPlan PointPlanMessage(const PointParameters& point, const Ladder& ladder);

v1::ComputingRates RatesMessage(const MachineRates& rates);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_PLAN_H_
