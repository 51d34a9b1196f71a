// ballpiston watch: shows the progress of a job until it ends, or waits for several jobs.
#include <condition_variable>
#include <deque>
#include <mutex>
#include <stop_token>
#include <thread>

#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/command/follow_job.h"
#include "client/command/selection.h"
#include "client/library/child_process.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

using Ended = absl::StatusOr<v1::EnsembleJob>;

// Watches jobs at the same time, each on its own thread.
class Watches {
 public:
  Watches(const Connection& connection, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      threads_.emplace_back([this, &connection, name](const std::stop_token& stop) {
        Add(connection.client.Watch(name, {}, {}, stop));
      });
    }
  }

  // Waits for the next job that ends, or whose watch fails.
  Ended Next() {
    std::unique_lock lock(mutex_);
    added_.wait(lock, [this] { return !ended_.empty(); });
    Ended next = std::move(ended_.front());
    ended_.pop_front();
    return next;
  }

 private:
  void Add(Ended ended) {
    const std::lock_guard lock(mutex_);
    ended_.push_back(std::move(ended));
    added_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable added_;
  std::deque<Ended> ended_;
  std::vector<std::jthread> threads_;  // the destructor stops them
};

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

// Prints the name and the state of each job when it ends.
VerbResult WatchSeveral(const Connection& connection, const std::vector<std::string>& names,
                        const Options& options, Terminal& terminal) {
  Watches watches(connection, names);
  const size_t count = options.any ? 1 : names.size();
  absl::Status first_error;
  ExitCode worst = ExitCode::kDone;
  for (size_t i = 0; i < count; ++i) {
    const Ended job = watches.Next();
    if (job.ok()) terminal.out << job->name() << ' ' << Spelling(job->state()) << std::endl;
    const VerbResult result = Finish(job, options, terminal);
    first_error.Update(result.status());
    if (result.ok()) worst = std::max(worst, *result);
  }
  return first_error.ok() ? VerbResult(worst) : first_error;
}

}  // namespace

VerbResult Watch(const Options& options, Terminal& terminal) {
  const JobStates states = options.any ? kActiveStates : JobStates();
  return WithJobs(options, terminal, states, [&](const auto& connection, const auto& names) {
    if (names.size() > 1) return WatchSeveral(connection, names, options, terminal);
    return Finish(FollowJob(connection, names.front(), StyleOf(options), terminal), options,
                  terminal);
  });
}

}  // namespace ballpiston::client
