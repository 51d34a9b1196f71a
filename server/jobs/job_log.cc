#include "server/jobs/job_log.h"

#include <cstdint>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/status.pb.h"
#include "server/convert/errors.h"
#include "server/convert/spec.h"
#include "server/jobs/job_name.h"
#include "server/observability/log.h"

namespace ballpiston::server {
namespace {

void LogCrash(const JobRecord& job) {
  const v1::EnsembleSpec spec = SpecFromBytes(job.spec).value_or(v1::EnsembleSpec());
  Log(Severity::kError,
      "the engine crashed again and again while it computed this job, which fails",
      {{"job", JobName(job.id)},
       {"principal", job.principal},
       {"question", spec.ShortDebugString()}});
}

}  // namespace

void LogState(const JobRecord& job, JobState state) {
  const std::string name = absl::AsciiStrToLower(v1::EnsembleJob::State_Name(state));
  Log(Severity::kInfo, absl::StrCat("job ", name),
      {{"job", JobName(job.id)}, {"principal", job.principal}, {"state", name}});
}

void LogEnd(const JobRecord& ended) {
  const std::string state = absl::AsciiStrToLower(v1::EnsembleJob::State_Name(ended.state));
  // A job without a start time ended before its first turn.
  const absl::Time begin = ended.start_time.value_or(ended.create_time);
  google::rpc::Status error;
  error.ParseFromString(ended.error);
  if (ReasonOf(error) == kEngineCrashed) LogCrash(ended);
  Log(ended.error.empty() ? Severity::kInfo : Severity::kWarning, absl::StrCat("job ", state),
      {{"job", JobName(ended.id)},
       {"principal", ended.principal},
       {"state", state},
       {"points", ended.numbers.points_done},
       {"samples", static_cast<int64_t>(ended.numbers.samples)},
       {"processor_seconds", ended.numbers.work},
       {"seconds", absl::ToDoubleSeconds(ended.end_time.value_or(begin) - begin)},
       {"error", error.message()}});
}

}  // namespace ballpiston::server
