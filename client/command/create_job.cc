#include "client/command/create_job.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "client/command/interrupts.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

// Advice for an exceeded limit, by the server's reason; null if the server's message is enough.
const char* HintOf(const std::string& reason) {
  if (reason == "TOO_MANY_POINTS") return "Split the grid between several jobs.";
  if (reason == "TOO_MANY_SAMPLES") return "Ask for fewer samples per point, or split the grid.";
  if (reason == "QUEUE_FULL") return "Retry when some of the jobs have ended.";
  if (reason == "TOO_MANY_JOBS" || reason == "TOO_MANY_ACTIVE_POINTS") {
    return "Wait until some of your jobs have ended, or cancel some: ballpiston list, ballpiston "
           "cancel JOB";
  }
  if (reason == "TOO_MANY_STORED_BYTES" || reason == "STORE_FULL") {
    return "Delete jobs that are no longer needed: ballpiston list, ballpiston delete JOB";
  }
  return nullptr;
}

absl::Status HintIfLimit(const absl::Status& status) {
  const char* hint = status.ok() ? nullptr : HintOf(ErrorReason(status));
  return hint == nullptr ? status : WithHint(status, hint);
}

absl::StatusOr<v1::EnsembleJob> CreateOnce(const Connection& connection,
                                           const v1::EnsembleSpec& spec,
                                           const CreateOptions& options, const Terminal& terminal) {
  const Interrupts::Scope scope(terminal.interrupts, [&] {
    terminal.err << "The server may have accepted the job. With --request-id " << options.request_id
                 << " the same command returns this job.\n";
  });
  terminal.Detail(absl::StrCat("request id ", options.request_id));
  auto job = connection.client.Create(spec, options);
  if (!job.ok()) return HintIfLimit(job.status());
  terminal.Detail(absl::StrCat("job ", job->name()));
  return job;
}

// Tries ids in order. If the job of an id failed or was cancelled, or its results have expired, the
// next id creates a new job.
absl::StatusOr<v1::EnsembleJob> Resume(const Connection& connection, const v1::EnsembleSpec& spec,
                                       CreateOptions options, const Terminal& terminal) {
  const auto status = connection.client.Status();
  if (!status.ok()) return status.status();
  const std::string question = absl::StrCat(status->engine_version(), " ", options.fresh, " ",
                                            options.priority, " ", spec.SerializeAsString(), " ");
  for (int attempt = 0;; ++attempt) {
    options.request_id = RequestIdFor(absl::StrCat(question, attempt));
    auto job = CreateOnce(connection, spec, options, terminal);
    const bool is_lost =
        job.ok() &&
        (job->state() == v1::EnsembleJob::FAILED || job->state() == v1::EnsembleJob::CANCELLED ||
         job->state() == v1::EnsembleJob::CANCELLING || job->results_expired());
    if (!is_lost) return job;
  }
}

std::string FromStoreText(const v1::EnsembleJob& job) {
  const absl::Time end = absl::FromUnixSeconds(job.end_time().seconds());
  return absl::StrCat("answered from the store: ", job.name(), ", computed ",
                      absl::FormatTime("%Y-%m-%d %H:%M UTC", end, absl::UTCTimeZone()),
                      " (--fresh computes it again)");
}

}  // namespace

absl::StatusOr<v1::EnsembleJob> CreateJob(const Connection& connection,
                                          const v1::EnsembleSpec& spec, const Options& options,
                                          const Terminal& terminal) {
  CreateOptions create = options.create;
  create.labels = options.labels;
  if (options.resume && create.request_id.empty()) {
    return Resume(connection, spec, create, terminal);
  }
  if (create.request_id.empty()) create.request_id = NewRequestId();
  return CreateOnce(connection, spec, create, terminal);
}

std::string ReusedText(const v1::EnsembleJob& job) {
  if (job.answered_from_store()) return FromStoreText(job);
  if (job.continues().empty()) return "";
  return absl::StrCat("continues ", job.continues(), ": ", ExactText(job.continued_samples()),
                      " samples are in the store (--fresh computes them again)");
}

}  // namespace ballpiston::client
