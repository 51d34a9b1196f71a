// A job as the API shows it, made from its row and from what memory knows about it. Pure functions.
#pragma once

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "google/protobuf/timestamp.pb.h"
#include "server/store/job_record.h"

namespace ballpiston::server {

// `numbers`: those in memory if the job is active. `retain_days`: results expire after this time;
// 0: never. A specification that cannot be read is left out.
v1::EnsembleJob JobMessage(const JobRecord& record, const JobNumbers& numbers, double retain_days);

// Without a fraction if a tolerance or a budget ends the points, not a number of samples.
v1::JobProgress ProgressOf(int64_t points, const v1::Target& target, const JobNumbers& numbers);

// A time in the API's format, to the nanosecond.
void SetTime(absl::Time time, google::protobuf::Timestamp* timestamp);

}  // namespace ballpiston::server
