#include "client/command/follow_job.h"

#include <memory>
#include <stop_token>

#include "absl/strings/str_cat.h"
#include "client/library/ensemble_client.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

std::string HowToReattach(const Connection& connection, const std::string& name) {
  return absl::StrCat("The job goes on. To watch it again: ballpiston watch ", name,
                      connection.flag);
}

std::string Hint(const Connection& connection, const std::string& name) {
  return absl::StrCat(HowToReattach(connection, name), "\nPress Ctrl-C again within ",
                      absl::ToInt64Seconds(Interrupts::kSecondPress), " s to cancel the job.");
}

WatchCallbacks Report(ProgressReporter& reporter) {
  return {.on_job = [&](const v1::EnsembleJob& job) { reporter.OnJob(job); },
          .on_snapshot = [&](const auto& snapshot) { reporter.OnSnapshot(snapshot); },
          .on_heartbeat = {},
          .on_disconnect = [&](const absl::Status& why,
                               absl::Duration pause) { reporter.OnDisconnect(why, pause); }};
}

// If the job has ended in the meantime there is nothing to cancel, and its result will be shown.
void Cancel(const EnsembleClient& client, const std::string& name, ProgressReporter& reporter,
            std::stop_source& stop) {
  const absl::Status status = client.Cancel(name).status();
  if (absl::IsFailedPrecondition(status)) return;
  reporter.Note(status.ok() ? absl::StrCat("cancelled ", name)
                            : absl::StrCat("could not cancel ", name, ": ", status.message()));
  stop.request_stop();
}

}  // namespace

absl::StatusOr<std::optional<v1::EnsembleJob>> FollowJob(const Connection& connection,
                                                         const std::string& name,
                                                         ProgressStyle style,
                                                         Interrupts& interrupts,
                                                         std::ostream& err) {
  const EnsembleClient client(connection.channel);
  const std::unique_ptr<ProgressReporter> reporter = NewProgressReporter(style, err, name);
  std::stop_source stop;
  absl::StatusOr<v1::EnsembleJob> job;
  {
    const Interrupts::Scope scope(interrupts,
                                  {.on_first = [&] { reporter->Note(Hint(connection, name)); },
                                   .on_second = [&] { Cancel(client, name, *reporter, stop); },
                                   .on_no_second = [&] { stop.request_stop(); }});
    WatchOptions options;
    // The watch reports what goes wrong.
    options.before_reattach = [&connection] { connection.Revive().IgnoreError(); };
    job = client.Watch(name, Report(*reporter), options, stop.get_token());
  }
  reporter->OnEnd();
  if (job.ok()) return *std::move(job);
  if (stop.stop_requested()) return std::nullopt;
  if (absl::IsUnavailable(job.status())) reporter->Note(HowToReattach(connection, name));
  return job.status();
}

ExitCode ReportEnd(const v1::EnsembleJob& job, std::ostream& err) {
  if (job.state() == v1::EnsembleJob::SUCCEEDED) return ExitCode::kDone;
  err << "ballpiston: " << job.name() << " " << Spelling(job.state());
  if (!job.error().message().empty()) err << ": " << job.error().message();
  err << std::endl;
  return ExitCode::kFailed;
}

}  // namespace ballpiston::client
