// ballpiston watch: shows the progress of a job until it ends, or waits for several jobs.
#include <algorithm>
#include <atomic>
#include <mutex>
#include <stop_token>
#include <thread>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/command/follow_job.h"
#include "client/library/child_process.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

using Ended = absl::StatusOr<v1::EnsembleJob>;

// Jobs that are watched at the same time. By default a server permits a principal no more streams.
constexpr size_t kMostWatches = 1'024;

VerbResult RunCommand(const v1::EnsembleJob& job, const Options& options) {
  if (options.command.empty()) return ExitCode::kDone;
  const absl::StatusOr<int> status =
      RunChild({.command = {"env", absl::StrCat("BALLPISTON_JOB=", job.name()),
                            absl::StrCat("BALLPISTON_JOB_STATE=", Spelling(job.state())), "/bin/sh",
                            "-c", options.command}});
  if (!status.ok()) return status.status();
  if (*status == 0) return ExitCode::kDone;
  return absl::InternalError(absl::StrCat("--exec ended with status ", *status));
}

// What follows the end of a job: the command, and the exit code.
VerbResult Finish(const Ended& job, const Options& options, const Terminal& terminal) {
  if (!job.ok()) return job.status();
  const VerbResult command = RunCommand(*job, options);
  if (!command.ok()) return command;
  return ReportEnd(*job, terminal);
}

// Watches each job on a thread, and prints its name and state when it ends; further jobs after the
// first kMostWatches have to wait for a thread. With --any the first one ends the other watches.
VerbResult WatchSeveral(const Connection& connection, const std::vector<v1::EnsembleJob>& jobs,
                        const Options& options, Terminal& terminal) {
  std::mutex mutex;  // one job at a time is reported
  absl::Status first_error;
  ExitCode worst = ExitCode::kDone;
  std::stop_source enough;
  const auto watch = [&](const std::string& name) {
    Ended job;
    do {  // again while the server has too many streams
      job = connection.client.Watch(name, {}, {}, enough.get_token());
    } while (ErrorReason(job.status()) == "TOO_MANY_STREAMS" && !enough.stop_requested());
    const std::lock_guard lock(mutex);
    if (enough.stop_requested()) return;
    if (options.any) enough.request_stop();
    if (job.ok()) terminal.out << job->name() << ' ' << Spelling(job->state()) << std::endl;
    const VerbResult result = Finish(job, options, terminal);
    first_error.Update(result.status());
    if (result.ok()) worst = std::max(worst, *result);
  };
  std::atomic<size_t> next = 0;
  const auto watch_some = [&] {
    for (size_t i = next++; i < jobs.size(); i = next++) watch(jobs[i].name());
  };
  const size_t most = options.any ? jobs.size() : std::min(jobs.size(), kMostWatches);
  std::vector<std::jthread> threads;
  const absl::Cleanup end = [&] { enough.request_stop(); };  // also if a thread cannot start
  while (next < jobs.size() && threads.size() < most) threads.emplace_back(watch_some);
  threads.clear();  // waits for them
  return first_error.ok() ? VerbResult(worst) : first_error;
}

}  // namespace

VerbResult Watch(const Options& options, Terminal& terminal) {
  const JobStates states = options.any ? kActiveStates : JobStates();
  return WithJobs(options, terminal, states, [&](const auto& connection, const auto& jobs) {
    if (jobs.size() > 1) return WatchSeveral(connection, jobs, options, terminal);
    return Finish(FollowJob(connection, jobs.front().name(), StyleOf(options), terminal), options,
                  terminal);
  });
}

}  // namespace ballpiston::client
