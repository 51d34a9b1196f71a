#include "server/cluster/slurm_workers.h"

#include <unistd.h>

#include <algorithm>
#include <span>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "server/host.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"

namespace ballpiston::server {
namespace {

// sbatch itself retries for 120 s while the cluster has no room for another job.
constexpr std::chrono::seconds kSubmitLimit(150);
constexpr std::chrono::seconds kOtherLimit(60);
// Before the time limit a worker has so long to end. Slurm looks at time limits every 30 s, so the
// signal comes up to 30 s earlier.
constexpr int kSecondsToFinish = 60;
constexpr double kMostSecondsToFinish = 90;
// A longer chunk would end near the time limit on a slow machine.
constexpr double kShareOfTheLimit = 0.5;

constexpr std::chrono::milliseconds kBetweenLooks(1000);
constexpr std::chrono::milliseconds kLongestPause(600'000);

// ---- the queue ----

// Reasons of Slurm 22.05. A task waits for an operator; quotas and limits of the number of jobs are
// not among them, because they pass.
constexpr absl::string_view kForever[] = {"AccountNotAllowed",
                                          "BadConstraints",
                                          "InvalidAccount",
                                          "InvalidQOS",
                                          "JobHeldAdmin",
                                          "JobHeldUser",
                                          "JobLaunchFailure",
                                          "PartitionConfig",
                                          "PartitionDown",
                                          "PartitionInactive",
                                          "PartitionNodeLimit",
                                          "PartitionTimeLimit",
                                          "QOSMinCpuNotSatisfied",
                                          "QOSNotAllowed",
                                          "QOSTimeLimit",
                                          "launch failed requeued held",
                                          "launch_failed_requeued_held"};
// Limits of one job, such as QOSMaxWallDurationPerJobLimit.
constexpr absl::string_view kOfOneJob = "PerJobLimit";

constexpr absl::string_view kWaiting[] = {"PENDING",     "REQUEUED",     "REQUEUE_HOLD",
                                          "REQUEUE_FED", "SPECIAL_EXIT", "RESV_DEL_HOLD"};
constexpr absl::string_view kRunning[] = {"RUNNING", "COMPLETING", "CONFIGURING", "SUSPENDED",
                                          "STOPPED", "SIGNALING",  "RESIZING",    "STAGE_OUT"};

bool IsOneOf(std::span<const absl::string_view> words, absl::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

// The tool's error messages, in one line.
std::string ErrorsOf(const CommandOutput& output) {
  std::vector<std::string> lines;
  for (absl::string_view line : absl::StrSplit(output.errors, '\n', absl::SkipWhitespace())) {
    for (const absl::string_view tool : {"sbatch: ", "squeue: ", "scancel: ", "error: "}) {
      absl::ConsumePrefix(&line, tool);
    }
    lines.emplace_back(line);
  }
  return lines.empty() ? absl::StrCat("exit code ", output.exit_code) : absl::StrJoin(lines, "; ");
}

// Quotes a word for sh.
std::string Quoted(const std::string& word) {
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

// This process's environment without the variables that change what the tools do.
std::vector<std::string> Environment() {
  std::vector<std::string> kept;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const absl::string_view text = *variable;
    const bool is_slurms =
        absl::StartsWith(text, "SLURM_") && !absl::StartsWith(text, "SLURM_CONF=");
    const bool changes_tools = absl::StartsWith(text, "SBATCH_") ||
                               absl::StartsWith(text, "SQUEUE_") ||
                               absl::StartsWith(text, "SCANCEL_");
    if (!is_slurms && !changes_tools) kept.emplace_back(text);
  }
  return kept;
}

}  // namespace

SlurmQueue ParseQueue(absl::string_view lines) {
  SlurmQueue queue;
  for (const absl::string_view line : absl::StrSplit(lines, '\n', absl::SkipEmpty())) {
    const std::vector<std::string> fields = absl::StrSplit(line, absl::MaxSplits('|', 1));
    if (fields.size() != 2) continue;
    queue.running += IsOneOf(kRunning, fields[0]);
    if (!IsOneOf(kWaiting, fields[0])) continue;
    ++queue.waiting;
    const bool is_forever = IsOneOf(kForever, fields[1]) || absl::EndsWith(fields[1], kOfOneJob);
    if (is_forever) queue.never = fields[1];
  }
  return queue;
}

double LongestChunk(const SlurmOptions& options) {
  const double limit = 60 * static_cast<double>(options.time_limit_minutes) - kMostSecondsToFinish;
  return kShareOfTheLimit * std::max(limit, 1.0);
}

// ---- the tools ----

SlurmTools::SlurmTools(const SlurmOptions& options, std::string name, std::string folder)
    : options_(options), name_(std::move(name)), folder_(std::move(folder)) {}

absl::StatusOr<std::string> SlurmTools::Run(Command command, const std::stop_token& stop) const {
  const std::string tool = command.words[0];
  if (!options_.cluster.empty()) {
    command.words.insert(command.words.begin() + 1, absl::StrCat("--clusters=", options_.cluster));
  }
  command.environment = Environment();
  absl::StatusOr<CommandOutput> run = RunCommand(command, stop);
  if (!run.ok()) return run.status();
  if (run->exit_code == 0) return std::move(run->output);
  return absl::UnavailableError(absl::StrCat(tool, ": ", ErrorsOf(*run)));
}

absl::Status SlurmTools::Submit(size_t workers, const std::stop_token& stop) {
  std::vector<std::string> words = {
      "sbatch",
      "--parsable",
      absl::StrCat("--job-name=", name_),
      absl::StrCat("--array=0-", workers - 1),
      absl::StrCat("--time=", options_.time_limit_minutes),
      absl::StrCat("--signal=B:USR1@", kSecondsToFinish),
      "--requeue",
      "--open-mode=append",
      absl::StrCat("--chdir=", folder_),
      absl::StrCat("--output=", folder_, "/log/%a.log"),
      absl::StrCat("--wrap=exec ", Quoted(folder_ + "/ballpiston-worker"), " ", Quoted(folder_))};
  if (!options_.partition.empty()) {
    words.push_back(absl::StrCat("--partition=", options_.partition));
  }
  if (!options_.account.empty()) words.push_back(absl::StrCat("--account=", options_.account));
  words.insert(words.end(), options_.sbatch_options.begin(), options_.sbatch_options.end());
  return Run({.words = std::move(words), .limit = kSubmitLimit}, stop).status();
}

absl::StatusOr<SlurmQueue> SlurmTools::Query(const std::stop_token& stop) {
  const absl::StatusOr<std::string> lines =
      Run({.words = {"squeue", "--noheader", "--me", "--array", absl::StrCat("--name=", name_),
                     absl::StrCat("--format=", kQueueFormat)},
           .limit = kOtherLimit},
          stop);
  if (!lines.ok()) return lines.status();
  return ParseQueue(*lines);
}

absl::Status SlurmTools::Cancel(const std::stop_token& stop) {
  return Run({.words = {"scancel", "--me", absl::StrCat("--name=", name_)}, .limit = kOtherLimit},
             stop)
      .status();
}

// ---- the workers ----

SlurmWorkers::SlurmWorkers(const SlurmOptions& options, std::unique_ptr<SlurmTools> tools,
                           std::function<FolderStatus()> work, std::function<absl::Status()> ready)
    : options_(options),
      tools_(std::move(tools)),
      work_(std::move(work)),
      ready_(std::move(ready)),
      array_size_(options.max_array_size) {}

void SlurmWorkers::Start() {
  looking_ = std::make_unique<PeriodicThread>(kBetweenLooks, [this] { Look(); });
}

void SlurmWorkers::Look() {
  const FolderStatus work = work_();
  const bool has_work = work.waiting_leases + work.taken_leases > 0;
  const Clock::time_point now = SteadyNow();
  if (now < next_query_ || (!has_work && !may_have_workers_)) return;
  const absl::Status steered = Steer(work);
  if (absl::IsCancelled(steered)) return;  // the server stops
  backoff_ = steered.ok() ? std::chrono::milliseconds(0)
                          : std::clamp(2 * backoff_, options_.query_interval, kLongestPause);
  next_query_ = now + std::max(backoff_, options_.query_interval);
  const std::string problem(steered.message());
  MutexLock lock(mutex_);
  if (std::exchange(status_.problem, problem) == problem) return;
  if (steered.ok()) return LogInfo("slurm: works again");
  LogError(absl::StrCat("slurm: ", problem));
}

absl::Status SlurmWorkers::Steer(const FolderStatus& work) {
  const absl::StatusOr<SlurmQueue> queue = tools_->Query(stop_.get_token());
  if (!queue.ok()) return queue.status();
  {
    MutexLock lock(mutex_);
    ++status_.queries;
    status_.queue = *queue;
  }
  const size_t found = queue->waiting + queue->running;
  const auto leases = static_cast<size_t>(work.waiting_leases + work.taken_leases);
  const size_t wanted = std::min(leases, options_.workers);
  may_have_workers_ = found > 0;
  if (found > 0 && (wanted == 0 || !queue->never.empty())) {
    absl::Status cancelled = tools_->Cancel(stop_.get_token());
    if (!cancelled.ok() || queue->never.empty()) return cancelled;
    return absl::UnavailableError("a worker would wait for ever: " + queue->never);
  }
  const absl::Status working = CheckThatWorkersWork(work, *queue);
  if (!working.ok() || found >= wanted) return working;
  return Fill(backoff_.count() > 0 ? 1 : wanted - found);
}

// Otherwise workers that cannot run would be submitted again for ever.
absl::Status SlurmWorkers::CheckThatWorkersWork(const FolderStatus& work, const SlurmQueue& queue) {
  const bool were_in_vain = has_submitted_ && queue.waiting + queue.running == 0 &&
                            work.claims == claims_ && work.waiting_leases > 0;
  has_submitted_ = false;
  claims_ = work.claims;
  if (!were_in_vain) return absl::OkStatus();
  return absl::UnavailableError(
      "workers have ended without taking a lease; their messages are in the folder's log/");
}

absl::Status SlurmWorkers::Fill(size_t missing) {
  const absl::Status ready = ready_();
  if (!ready.ok()) return ready;
  while (missing > 0) {
    const size_t workers = std::min(missing, array_size_);
    absl::Status submitted = tools_->Submit(workers, stop_.get_token());
    const bool is_too_large = absl::StrContains(submitted.message(), "Invalid job array");
    if (is_too_large && array_size_ > 1) {
      array_size_ = std::max(workers / 2, size_t{1});
      Log(Severity::kWarning, absl::StrCat("slurm: arrays have at most ", array_size_,
                                           " tasks now: set --slurm-max-array-size"));
      continue;
    }
    // An error does not prove that Slurm has no workers of this array.
    may_have_workers_ = true;
    if (!submitted.ok()) return submitted;
    Failpoint("cluster.submitted");
    has_submitted_ = true;
    missing -= workers;
  }
  return absl::OkStatus();
}

SlurmStatus SlurmWorkers::Status() const {
  MutexLock lock(mutex_);
  return status_;
}

}  // namespace ballpiston::server
