#include "client/command/create_job.h"

#include <CLI/CLI.hpp>
#include <limits>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "client/command/number_list.h"
#include "client/command/violations.h"
#include "client/library/error_text.h"
#include "client/library/quoted.h"
#include "client/library/request_id.h"

namespace ballpiston::client {
namespace {

// What the user can do about a limit, by the server's reason; null where its message says it all.
const char* HintOf(const std::string& reason) {
  if (reason == "TOO_MANY_POINTS") return "Split the grid between several jobs.";
  if (reason == "TOO_MANY_SAMPLES") return "Ask for fewer a point, or split the grid.";
  if (reason == "QUEUE_FULL") return "Try again when some of them have ended.";
  if (reason == "TOO_MANY_JOBS" || reason == "TOO_MANY_ACTIVE_POINTS") {
    return "Wait until some of them have ended, or cancel some: ballpiston list, ballpiston cancel "
           "JOB";
  }
  if (reason == "STORE_FULL") {
    return "Delete jobs that are no longer needed: ballpiston list, ballpiston delete JOB";
  }
  return nullptr;
}

absl::Status WithHint(const absl::Status& status) {
  const char* hint = absl::IsResourceExhausted(status) ? HintOf(ErrorReason(status)) : nullptr;
  if (hint == nullptr) return status;
  absl::Status with_hint(status.code(), absl::StrCat(status.message(), "\n", hint));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    with_hint.SetPayload(type, payload);
  });
  return with_hint;
}

absl::Status SetPriority(const std::optional<std::string>& flag, CreateOptions& options) {
  if (!flag) return absl::OkStatus();
  const absl::StatusOr<int64_t> priority = ParseCount("--priority", *flag);
  if (!priority.ok()) return priority.status();
  using Limits = std::numeric_limits<int32_t>;
  if (*priority < Limits::min() || *priority > Limits::max()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--priority: ", Quoted(*flag), " is not a number from -100 to 100"));
  }
  options.priority = static_cast<int32_t>(*priority);
  return absl::OkStatus();
}

absl::Status CheckRequestId(const std::optional<std::string>& flag) {
  if (!flag || IsRequestId(*flag)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "--request-id: ", Quoted(*flag), " is not a UUID like 123e4567-e89b-12d3-a456-426614174000"));
}

}  // namespace

void JobFlags::AddTo(CLI::App& verb) {
  verb.add_flag("--fresh", fresh,
                "compute, even if the same question was answered before and its answer is stored");
  verb.add_option("--priority", priority,
                  "-100 to 100, 0 if not given: among your own jobs the higher goes first");
  verb.add_option("--request-id", request_id,
                  "a UUID of your own: asked again with it (no answer came), the server gives the "
                  "job that it made the first time");
}

absl::StatusOr<CreateOptions> OptionsOf(const JobFlags& flags) {
  CreateOptions options;
  options.fresh = flags.fresh;
  options.request_id = flags.request_id.value_or("");
  const Violations violations(
      {SetPriority(flags.priority, options), CheckRequestId(flags.request_id)});
  if (absl::Status bad = violations.Lines(); !bad.ok()) return bad;
  return options;
}

absl::StatusOr<v1::EnsembleJob> CreateJob(const Connection& connection,
                                          const v1::EnsembleSpec& spec, CreateOptions options) {
  const EnsembleClient client(connection.channel);
  if (options.request_id.empty()) options.request_id = NewRequestId();
  auto job = connection.Ask([&] { return client.Create(spec, options); });
  if (!job.ok()) return WithHint(job.status());
  return job;
}

std::string FromStoreText(const v1::EnsembleJob& job) {
  const absl::Time end = absl::FromUnixSeconds(job.end_time().seconds());
  return absl::StrCat("answered from the store: ", job.name(), ", computed ",
                      absl::FormatTime("%Y-%m-%d %H:%M UTC", end, absl::UTCTimeZone()),
                      " (--fresh computes anew)");
}

}  // namespace ballpiston::client
