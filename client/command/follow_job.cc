#include "client/command/follow_job.h"

#include "absl/strings/str_cat.h"
#include "client/command/interrupts.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

std::string FarewellText(const Connection& connection, const std::string& name) {
  return absl::StrCat("The job continues.\n  watch it again:  ballpiston watch ", name,
                      connection.flags, "\n  cancel it:       ballpiston cancel ", name,
                      connection.flags);
}

WatchCallbacks Report(ProgressReporter& reporter) {
  return {.on_job = [&](const v1::EnsembleJob& job) { reporter.OnJob(job); },
          .on_snapshot = [&](const auto& snapshot) { reporter.OnSnapshot(snapshot); },
          .on_disconnect = [&](const absl::Status& why,
                               absl::Duration pause) { reporter.OnDisconnect(why, pause); }};
}

}  // namespace

ProgressStyle StyleOf(const Options& options) {
  const bool is_silent = options.verbosity == Verbosity::kQuiet && !options.progress_beats_quiet &&
                         !options.given.contains("--progress");
  return is_silent ? ProgressStyle::kNone : options.progress;
}

absl::StatusOr<v1::EnsembleJob> FollowJob(const Connection& connection, const std::string& name,
                                          ProgressStyle style, const Terminal& terminal) {
  ProgressReporter reporter(style, terminal.err, name);
  const std::string farewell = FarewellText(connection, name);
  const OnInterrupt scope([&] { reporter.Farewell(farewell); });
  absl::StatusOr<v1::EnsembleJob> job = connection.client.Watch(name, Report(reporter));
  reporter.OnEnd();
  if (!job.ok() && !absl::IsNotFound(job.status())) reporter.Note(farewell);
  return job;
}

ExitCode ReportEnd(const v1::EnsembleJob& job, const Terminal& terminal) {
  if (job.state() == v1::EnsembleJob::SUCCEEDED) return ExitCode::kDone;
  terminal.err << "ballpiston: " << job.name() << " " << Spelling(job.state());
  if (!job.error().message().empty()) terminal.err << ": " << job.error().message();
  terminal.err << std::endl;
  return ExitCode::kFailed;
}

}  // namespace ballpiston::client
