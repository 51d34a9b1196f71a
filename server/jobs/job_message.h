// A job as the API shows it. Pure functions.
#ifndef BALLPISTON_SERVER_JOBS_JOB_MESSAGE_H_
#define BALLPISTON_SERVER_JOBS_JOB_MESSAGE_H_

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "google/protobuf/timestamp.pb.h"
#include "server/store/job_record.h"

namespace ballpiston::server {

// The message of a row, with the row's progress. A specification that cannot be read is left out.
v1::EnsembleJob JobMessage(const JobRecord& record);

// A time in the API's format, to the nanosecond.
void SetTime(absl::Time time, google::protobuf::Timestamp* timestamp);

// Whether a tolerance or a budget ends the job's points, not a number of samples.
bool IsOpenEnded(const v1::Target& target);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_MESSAGE_H_
