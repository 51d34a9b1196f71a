// A job as the API shows it, made from its row and from what memory knows about it. Pure functions.
#pragma once

#include <cstdint>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "google/protobuf/timestamp.pb.h"
#include "server/store/job_record.h"

namespace ballpiston::server {

// The numbers of an active job.
struct LiveNumbers {
  int64_t points_done = 0;     // these are stored
  double points_computed = 0;  // with the computed shares of unfinished points
  double samples = 0;
  double work = 0;    // seconds of processor time in this process
  int64_t bytes = 0;  // JobRecord::bytes
};

// `live`: null if the job has ended, or if nothing was computed yet; then the row has the numbers.
// `retain_days`: results expire after this time; 0: never. A specification that cannot be read is
// left out.
v1::EnsembleJob JobMessage(const JobRecord& record, const LiveNumbers* live, double retain_days);

// `open_ended`: there is no fraction.
v1::JobProgress ProgressOf(int64_t points, bool open_ended, const LiveNumbers& numbers);

// A time in the API's format, to the nanosecond.
void SetTime(absl::Time time, google::protobuf::Timestamp* timestamp);

// Whether a tolerance or a budget ends the job's points, not a number of samples.
bool IsOpenEnded(const v1::Target& target);

}  // namespace ballpiston::server
