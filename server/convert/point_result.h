// A stored result as the API's PointResult. Pure function.
#ifndef BALLPISTON_SERVER_CONVERT_POINT_RESULT_H_
#define BALLPISTON_SERVER_CONVERT_POINT_RESULT_H_

#include "ballpiston/storage/records.pb.h"
#include "ballpiston/v1/result.pb.h"

namespace ballpiston::server {

v1::PointResult PointResultMessage(const storage::Result& record);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_POINT_RESULT_H_
