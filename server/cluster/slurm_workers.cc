#include "server/cluster/slurm_workers.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
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

// Quotes a word for sh.
std::string Quoted(absl::string_view word) {
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

// `env`, which removes the variables that change what the tools do.
std::string WithoutSlurmsVariables() {
  std::string line = "env";
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const absl::string_view text = *variable;
    const absl::string_view name = text.substr(0, text.find('='));
    if (name == "SLURM_CONF" || name == "SLURM_JWT") continue;  // configuration, token
    for (const absl::string_view prefix : {"SLURM_", "SBATCH_", "SQUEUE_", "SCANCEL_"}) {
      if (absl::StartsWith(name, prefix)) absl::StrAppend(&line, " -u ", Quoted(name));
    }
  }
  return line;
}

// The error messages in what the tool printed, in one line.
std::string ErrorsIn(absl::string_view output, int exit_code) {
  std::vector<std::string> lines;
  for (absl::string_view line : absl::StrSplit(output, '\n', absl::SkipWhitespace())) {
    for (const absl::string_view origin :
         {"timeout: ", "sbatch: ", "squeue: ", "scancel: ", "error: "}) {
      absl::ConsumePrefix(&line, origin);
    }
    lines.emplace_back(line);
  }
  return lines.empty() ? absl::StrCat("exit code ", exit_code) : absl::StrJoin(lines, "; ");
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

// `exec` leaves no shell between this process and `timeout`, so the exit status is that of
// `timeout`: at the limit SIGKILL ends `timeout` too.
absl::StatusOr<std::string> SlurmTools::Run(std::vector<std::string> words,
                                            std::chrono::seconds limit) const {
  const std::string tool = words[0];
  if (!options_.cluster.empty()) {
    words.insert(words.begin() + 1, absl::StrCat("--clusters=", options_.cluster));
  }
  std::string line =
      absl::StrCat("exec ", WithoutSlurmsVariables(), " timeout -s KILL ", limit.count());
  for (const std::string& word : words) absl::StrAppend(&line, " ", Quoted(word));
  FILE* const pipe = popen(absl::StrCat(line, " </dev/null 2>&1").c_str(), "re");
  if (pipe == nullptr) {
    return absl::UnavailableError(absl::StrCat(tool, ": ", std::strerror(errno)));
  }
  std::string output;
  char buffer[4096];
  // Not fread, which keeps the stream locked: at its end the server would wait in fflush.
  while (true) {
    const ssize_t size = read(fileno(pipe), buffer, sizeof(buffer));
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    output.append(buffer, static_cast<size_t>(size));
  }
  const int status = pclose(pipe);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
    return absl::UnavailableError(
        absl::StrCat(tool, " was killed; its time limit is ", limit.count(), " s"));
  }
  if (WIFSIGNALED(status)) {
    return absl::UnavailableError(absl::StrCat(tool, ": ended by signal ", WTERMSIG(status)));
  }
  if (status == 0) return output;
  return absl::UnavailableError(absl::StrCat(tool, ": ", ErrorsIn(output, WEXITSTATUS(status))));
}

absl::Status SlurmTools::Submit(size_t workers) {
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
  return Run(std::move(words), kSubmitLimit).status();
}

absl::StatusOr<SlurmQueue> SlurmTools::Query() {
  const absl::StatusOr<std::string> lines =
      Run({"squeue", "--noheader", "--me", "--array", absl::StrCat("--name=", name_),
           absl::StrCat("--format=", kQueueFormat)},
          kOtherLimit);
  if (!lines.ok()) return lines.status();
  return ParseQueue(*lines);
}

absl::Status SlurmTools::Cancel(bool also_running) {
  std::vector<std::string> words = {"scancel", "--me", absl::StrCat("--name=", name_)};
  if (!also_running) words.push_back("--state=PENDING");
  return Run(std::move(words), kOtherLimit).status();
}

// ---- the workers ----

SlurmWorkers::SlurmWorkers(const SlurmOptions& options, std::unique_ptr<SlurmTools> tools,
                           std::function<FolderStatus()> work, std::function<absl::Status()> ready)
    : options_(options),
      tools_(std::move(tools)),
      work_(std::move(work)),
      ready_(std::move(ready)),
      array_size_(options.max_array_size),
      step_(options.workers) {}

void SlurmWorkers::Start() {
  looking_ = std::make_unique<PeriodicThread>(kBetweenLooks, [this] { Look(); });
}

void SlurmWorkers::Look() {
  const FolderStatus work = work_();
  if (work.waiting_leases == 0) submitted_ = 0;  // then a worker rightly ends without a lease
  const bool has_work = work.waiting_leases + work.taken_leases > 0;
  const Clock::time_point now = SteadyNow();
  const bool is_idle = !has_work && !may_have_workers_ && backoff_.count() == 0;
  if (now < next_query_ || is_idle) return;
  absl::Status steered;
  // An exception that left this thread would end the server.
  try {
    steered = Steer(work);
  } catch (const std::exception& error) {
    steered = absl::InternalError(error.what());
  }
  if (!steered.ok()) {
    backoff_ = std::clamp(2 * backoff_, options_.query_interval, kLongestPause);
  } else if (fault_.ok()) {
    backoff_ = std::chrono::milliseconds(0);
  }
  next_query_ = now + std::max(backoff_, options_.query_interval);
  const std::string problem(steered.ok() ? fault_.message() : steered.message());
  MutexLock lock(mutex_);
  if (std::exchange(status_.problem, problem) == problem) return;
  if (problem.empty()) return LogInfo("slurm: works again");
  LogError(absl::StrCat("slurm: ", problem));
}

absl::Status SlurmWorkers::Steer(const FolderStatus& work) {
  const absl::StatusOr<SlurmQueue> queue = tools_->Query();
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
  // For a moment the folder may be empty although there is work.
  const bool is_empty = wanted == 0 && work.problem.empty();
  const bool has_ended = std::exchange(was_empty_, is_empty) && is_empty;
  if (wanted > 0 || has_ended || !queue->never.empty()) {
    const absl::Status judged = Judge(work, *queue, wanted);
    if (!judged.ok()) return judged;
  }
  if (has_ended && found > 0) {
    trial_.reset();
    submitted_ = 0;
    return tools_->Cancel(true);
  }
  const bool is_tried = !fault_.ok() && trial_;
  if (found >= wanted || is_tried) return absl::OkStatus();
  const absl::Status filled = Fill(std::min(wanted - found, step_));
  if (filled.ok() && !trial_) trial_ = work.claims;
  return filled;
}

// Changes the state, as the table in the header says. Returns a fault that is found now.
absl::Status SlurmWorkers::Judge(const FolderStatus& work, const SlurmQueue& queue, size_t wanted) {
  if (!queue.never.empty()) {
    absl::Status cancelled = tools_->Cancel(false);
    return cancelled.ok() ? Fails("a worker would wait for ever: " + queue.never) : cancelled;
  }
  const size_t found = queue.waiting + queue.running;
  const bool took_leases = trial_ && work.claims > *trial_;
  const double accounted = work.claims + static_cast<double>(found);
  const bool some_ended = accounted < submitted_ && work.waiting_leases > 0;
  // One such end may be Slurm's or a user's doing: a waiting worker was lost or cancelled.
  const bool some_fail = some_ended && (some_ended_ || found == 0 || !fault_.ok());
  // While workers wait, it is not known yet whether they fail too.
  if (some_ended || queue.waiting == 0) some_ended_ = some_ended;
  submitted_ = std::clamp(submitted_, work.claims + static_cast<double>(queue.waiting), accounted);
  if (some_fail) {
    return Fails(
        "workers have ended without taking a lease; their messages are in the folder's log/");
  }
  if (took_leases || found == 0) trial_.reset();
  if (took_leases || (!trial_ && found >= wanted)) fault_ = absl::OkStatus();
  return absl::OkStatus();
}

absl::Status SlurmWorkers::Fails(const std::string& why) {
  trial_.reset();
  submitted_ = 0;
  step_ = 1;
  return fault_ = absl::UnavailableError(why);
}

absl::Status SlurmWorkers::Fill(size_t missing) {
  const absl::Status ready = ready_();
  if (!ready.ok()) return ready;
  absl::Status submitted = SubmitArrays(missing);
  step_ = submitted.ok() ? std::min(2 * step_, options_.workers) : std::max(missing / 2, size_t{1});
  return submitted;
}

absl::Status SlurmWorkers::SubmitArrays(size_t missing) {
  while (missing > 0) {
    const size_t workers = std::min(missing, array_size_);
    absl::Status submitted = tools_->Submit(workers);
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
    submitted_ += static_cast<double>(workers);
    missing -= workers;
  }
  return absl::OkStatus();
}

SlurmStatus SlurmWorkers::Status() const {
  MutexLock lock(mutex_);
  return status_;
}

}  // namespace ballpiston::server
