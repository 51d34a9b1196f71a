// A stored result as the API's PointResult. Pure functions.
#pragma once

#include "ballpiston/storage/records.pb.h"
#include "ballpiston/v1/result.pb.h"
#include "core/ensemble/experiment_kind.h"

namespace ballpiston::server {

v1::PointResult PointResultMessage(const storage::Result& record);  // without details
// `experiment`: of the result's job.
v1::PointResult PointResultMessage(const storage::Result& record, const storage::Details& details,
                                   const ExperimentKind& experiment);

}  // namespace ballpiston::server
