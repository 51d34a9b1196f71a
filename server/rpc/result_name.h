// The names of results as clients see them. The store keeps results without their names.
#pragma once

#include <string>
#include <utility>

#include "ballpiston/v1/result.pb.h"
#include "server/book/job_name.h"

namespace ballpiston::server {

inline v1::PointResult Named(v1::PointResult result, const std::string& job_id) {
  result.set_name(ResultName(job_id, result.index()));
  return result;
}

}  // namespace ballpiston::server
