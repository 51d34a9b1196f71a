#include "server/jobs/job_log.h"

#include <cstdint>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/status.pb.h"
#include "server/jobs/job_name.h"
#include "server/observability/log.h"

namespace ballpiston::server {

void LogState(const Job& job, JobState state) {
  const std::string name = absl::AsciiStrToLower(v1::EnsembleJob::State_Name(state));
  Log(Severity::kInfo, absl::StrCat("job ", name),
      {{"job", JobName(job.id())}, {"principal", job.principal()}, {"state", name}});
}

void LogEnd(const JobRecord& ended) {
  const std::string state = absl::AsciiStrToLower(v1::EnsembleJob::State_Name(ended.state));
  // A job without a start time ended before its first turn.
  const absl::Time begin = ended.start_time.value_or(ended.create_time);
  google::rpc::Status error;
  error.ParseFromString(ended.error);
  Log(ended.error.empty() ? Severity::kInfo : Severity::kWarning, absl::StrCat("job ", state),
      {{"job", JobName(ended.id)},
       {"principal", ended.principal},
       {"state", state},
       {"points", ended.points_done},
       {"samples", static_cast<int64_t>(ended.samples)},
       {"processor_seconds", ended.work},
       {"seconds", absl::ToDoubleSeconds(ended.end_time.value_or(begin) - begin)},
       {"error", error.message()}});
}

void LogCrashed(const JobRecord& job, const std::string& points, const v1::EnsembleSpec& spec) {
  Log(Severity::kError,
      "the engine crashed again and again while it computed this job, which fails",
      {{"job", JobName(job.id)},
       {"principal", job.principal},
       {"points", points},
       {"question", spec.ShortDebugString()}});
}

}  // namespace ballpiston::server
