#include "server/cluster/slurm_executor.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>
#include <random>
#include <system_error>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/engine_version.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"
#include "server/worker/crash_mark.h"
#include "server/worker/task_file.h"

namespace ballpiston::server {
namespace {

// A task has ended if it was missing in this many queries. One query is not enough, because a file
// may become visible on another machine a minute after it was written.
constexpr int kMissingQueries = 2;
// While points are being opened, leases are gathered so that one array has many.
constexpr int kGatherLooks = 2;
constexpr std::chrono::seconds kFirstBackoff(30);
constexpr std::chrono::seconds kLongestBackoff(600);

// Slurm's signal comes at most this long before the time limit (slurm_tools.cc).
constexpr double kMostSecondsToFinish = 90;
// A longer chunk would end near the time limit on a slow machine.
constexpr double kShareOfTheLimit = 0.5;

double Seconds(std::chrono::duration<double> duration) { return duration.count(); }

// Beside this program, as in a build folder, or in libexec, as installed.
std::string InstalledWorker() {
  std::error_code error;
  const std::filesystem::path folder =
      std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::filesystem::path beside = folder / "ballpiston-worker";
  if (std::filesystem::exists(beside, error)) return beside;
  return folder.parent_path() / "libexec/ballpiston/ballpiston-worker";
}

Capacity CapacityOf(const SlurmOptions& options) {
  const double limit =
      std::max(60 * static_cast<double>(options.time_limit_minutes) - kMostSecondsToFinish, 1.0);
  return {.seconds = std::min(Seconds(options.task_length), kShareOfTheLimit * limit),
          .longest_chunk = kShareOfTheLimit * limit};
}

double SecondsOf(const std::vector<Lease>& leases) {
  double seconds = 0;
  for (const Lease& lease : leases) seconds += lease.seconds;
  return seconds;
}

}  // namespace

SlurmExecutor::SlurmExecutor(Scheduler& scheduler, SlurmOptions options,
                             std::unique_ptr<SlurmTools> tools, std::string identity,
                             std::function<absl::Status()> flush,
                             std::shared_ptr<CrashRecord> crashes)
    : scheduler_(scheduler),
      options_(std::move(options)),
      tools_(std::move(tools)),
      identity_(std::move(identity)),
      prefix_(absl::StrCat("bp-", identity_, "-")),
      flush_(std::move(flush)),
      crashes_(std::move(crashes)),
      folder_(options_.shared_folder, identity_),
      capacity_(CapacityOf(options_)),
      array_size_(options_.max_array_size) {
  capacity_.executor = scheduler_.AddExecutor(*this);
}

SlurmExecutor::~SlurmExecutor() {
  Shutdown();
  scheduler_.RemoveExecutor(capacity_.executor);
}

void SlurmExecutor::Start() {
  recovered_ = Recover();
  collector_ = std::thread([this] { CollectUntilStopped(); });
  steerer_ = std::thread([this] { SteerUntilStopped(); });
}

void SlurmExecutor::Wake() {}  // both threads look every second

void SlurmExecutor::Shutdown() {
  stop_.request_stop();
  {
    MutexLock lock(mutex_);
    changed_.NotifyAll();
  }
  if (collector_.joinable()) collector_.join();
  if (steerer_.joinable()) steerer_.join();
}

bool SlurmExecutor::AwaitNextLook() {
  const Clock::time_point next = Clock::now() + options_.collect_interval;
  MutexLock lock(mutex_);
  while (!stop_.stop_requested() && changed_.WaitUntil(mutex_, next)) continue;
  return !stop_.stop_requested();
}

JobIdentity SlurmExecutor::IdentityOf(const Lease& lease) const {
  return {.server = identity_,
          .job = lease.run,
          .generation = lease.generation,
          .engine_version = std::string(kEngineVersion)};
}

void SlurmExecutor::NoteOutcome(Activity activity, const absl::Status& outcome) {
  const std::string problem(outcome.message());
  MutexLock lock(mutex_);
  std::string& known = problems_[static_cast<size_t>(activity)];
  if (std::exchange(known, problem) == problem) return;
  if (outcome.ok()) return LogInfo("slurm: works again");
  LogError(absl::StrCat("slurm: ", problem));
}

// ---- files ----

void SlurmExecutor::CollectUntilStopped() {
  do {
    Guarded(Activity::kFiles, [this] {
      absl::Status all;
      for (const std::string& name : ArrayNames()) all.Update(CollectArray(name));
      return all;
    });
  } while (AwaitNextLook());
}

std::vector<std::string> SlurmExecutor::ArrayNames() const {
  MutexLock lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, array] : arrays_) names.push_back(name);
  return names;
}

absl::Status SlurmExecutor::CollectArray(const std::string& name) {
  MutexLock one_at_a_time(collect_mutex_);
  if (!HasArray(name)) return absl::OkStatus();  // it was removed meanwhile
  const absl::StatusOr<std::vector<ChunkFileName>> files = ListChunkFiles(folder_.PathOf(name));
  if (!files.ok()) return files.status();
  for (const ChunkFileName& file : *files) {
    if (stop_.stop_requested()) break;
    if (!IsNew(name, file)) continue;
    scheduler_.AwaitRoom();
    TakeFile(name, file);
  }
  return absl::OkStatus();
}

bool SlurmExecutor::HasArray(const std::string& name) const {
  MutexLock lock(mutex_);
  return arrays_.contains(name);
}

SlurmExecutor::Task* SlurmExecutor::FindTask(const std::string& array, size_t task) {
  const auto found = arrays_.find(array);
  if (found == arrays_.end() || task >= found->second.tasks.size()) return nullptr;
  return &found->second.tasks[task];
}

bool SlurmExecutor::IsNew(const std::string& array, const ChunkFileName& file) {
  MutexLock lock(mutex_);
  const Task* task = FindTask(array, file.task);
  return task != nullptr && task->state != TaskState::kOver &&
         !task->read_files.contains(file.sequence);
}

void SlurmExecutor::TakeFile(const std::string& array, const ChunkFileName& name) {
  const absl::StatusOr<ChunkFile> file = ReadChunkFile(folder_.PathOf(array), name);
  if (absl::IsUnavailable(file.status()) || absl::IsNotFound(file.status())) return;
  std::vector<Lease> leases;
  {
    MutexLock lock(mutex_);
    if (const Task* task = FindTask(array, name.task)) leases = task->leases;
  }
  absl::Status taken = file.status();
  if (taken.ok()) taken = CheckFile(array, *file, leases);
  if (taken.ok()) taken = ReportFile(*file, leases);
  Failpoint("slurm.file_reported");
  if (absl::IsUnavailable(taken)) return NoteUnread(array, name);
  if (!taken.ok()) LogError(absl::StrCat("slurm: a chunk file is refused: ", taken.message()));
  NoteFile(array, name, file, taken);
}

// DATA_LOSS unless the file belongs to this array and its chunks to the leases of its task.
absl::Status SlurmExecutor::CheckFile(const std::string& array, const ChunkFile& file,
                                      const std::vector<Lease>& leases) const {
  const auto refuse = [&](absl::string_view why) {
    return absl::DataLossError(
        absl::StrCat(array, "/", ChunkFileName{file.task, file.sequence}.Text(), ": ", why));
  };
  if (file.array != array) return refuse(absl::StrCat("is of array ", file.array));
  for (const LeaseChunks& of_lease : file.leases) {
    if (of_lease.lease >= leases.size()) return refuse("has a lease that its task has not");
    const Lease& lease = leases[of_lease.lease];
    const absl::Status checked = CheckLeaseChunks({IdentityOf(lease), lease}, of_lease);
    if (!checked.ok()) return refuse(checked.message());
  }
  return absl::OkStatus();
}

// UNAVAILABLE if a point is not open yet: then the whole file is reported again later.
absl::Status SlurmExecutor::ReportFile(const ChunkFile& file, const std::vector<Lease>& leases) {
  absl::Status taken;
  for (const LeaseChunks& of_lease : file.leases) {
    if (scheduler_.IsUnopened(leases[of_lease.lease])) {
      return absl::UnavailableError("a point is not open yet");
    }
  }
  for (const LeaseChunks& of_lease : file.leases) {
    const Lease& lease = leases[of_lease.lease];
    const CrashRecord::Examining examining(*crashes_, {lease.run, lease.generation});
    const absl::Status reported = scheduler_.Report(
        lease, {.chunks = of_lease.chunks, .seconds = of_lease.processor_seconds});
    if (absl::IsUnavailable(reported)) return reported;
    if (!reported.ok()) taken = reported;
  }
  return taken;
}

void SlurmExecutor::NoteUnread(const std::string& array, const ChunkFileName& name) {
  MutexLock lock(mutex_);
  if (Task* task = FindTask(array, name.task)) task->has_unread_file = true;
}

void SlurmExecutor::NoteFile(const std::string& array, const ChunkFileName& name,
                             const absl::StatusOr<ChunkFile>& file, const absl::Status& taken) {
  MutexLock lock(mutex_);
  Task* task = FindTask(array, name.task);
  if (task == nullptr) return;
  task->read_files.insert(name.sequence);
  task->has_unread_file = false;
  if (!taken.ok()) ++counts_.refused_files;
  if (!file.ok() || absl::IsDataLoss(taken)) return;
  task->left_a_file = true;
  backoff_ = std::chrono::milliseconds(0);
  if (file->is_final) task->is_final = true;
  if (file->memory_exceeded > 0 && file->memory_exceeded < node_memory_) {
    node_memory_ = file->memory_exceeded;
    LogInfo(
        absl::StrFormat("slurm: a task may use %.0f MB of memory; points that need more are "
                        "computed here",
                        node_memory_ / 1e6));
  }
  for (const LeaseChunks& of_lease : file->leases) {
    counts_.chunks += static_cast<double>(of_lease.chunks.size());
  }
}

// ---- tasks of an earlier process ----

bool SlurmExecutor::Recover() {
  const absl::Status prepared = folder_.Prepare();
  NoteOutcome(Activity::kFiles, prepared);
  if (!prepared.ok()) return false;
  const auto names = folder_.ListArrays(prefix_);
  NoteOutcome(Activity::kFiles, names.status());
  if (!names.ok()) return false;
  for (const std::string& name : *names) RecoverArray(name);
  return true;
}

void SlurmExecutor::RecoverArray(const std::string& name) {
  Array array{.submitted = true, .submit_time = Clock::now()};
  const auto tasks = ReadTasks(TaskFileIn(folder_.PathOf(name)));
  if (!tasks.ok()) LogError(absl::StrCat("slurm: ", tasks.status().message()));
  if (tasks.ok()) {
    for (const std::vector<IdentifiedLease>& of_task : *tasks) {
      array.tasks.push_back(RecoveredTask(of_task));
    }
  }
  MutexLock lock(mutex_);
  arrays_.emplace(name, std::move(array));
}

SlurmExecutor::Task SlurmExecutor::RecoveredTask(const std::vector<IdentifiedLease>& leases) {
  Task task;
  for (const auto& [job, recorded] : leases) {
    Lease lease = recorded;
    lease.executor = capacity_.executor;
    lease.run = job.job;
    lease.generation = job.generation;
    const bool is_ours = job == IdentityOf(lease);
    const std::optional<Lease> adopted = is_ours ? scheduler_.Adopt(lease) : std::nullopt;
    task.leases.push_back(adopted.value_or(lease));
  }
  return task;
}

// ---- Slurm ----

void SlurmExecutor::SteerUntilStopped() {
  do {
    Guarded(Activity::kQueue, [this] {
      Steer();
      return absl::OkStatus();
    });
  } while (AwaitNextLook());
}

void SlurmExecutor::Steer() {
  // Points that were opened meanwhile adopt nothing; then the array is cancelled.
  if (!recovered_) recovered_ = Recover();
  if (!recovered_) return;
  EndFinalTasks();
  DropUnneededTasks();
  QueryIfDue();
  SubmitNew();
  RemoveEnded();
}

// An exception, for example out of memory, becomes a problem in Status() and does not end the
// server.
void SlurmExecutor::Guarded(Activity activity, absl::FunctionRef<absl::Status()> round) {
  absl::Status outcome;
  try {
    outcome = round();
    if (activity == Activity::kQueue) return;  // its parts have set their own problems
  } catch (const std::exception& error) {
    outcome = absl::InternalError(error.what());
  }
  NoteOutcome(activity, outcome);
}

// The tasks' leases go back to the scheduler without the lock.
void SlurmExecutor::EndTasks(const std::function<bool(const Task&)>& has_ended, bool tried) {
  std::vector<Lease> returned, crashed;
  {
    MutexLock lock(mutex_);
    for (auto& [name, array] : arrays_) {
      for (Task& task : array.tasks) {
        if (task.state == TaskState::kOver || !has_ended(task)) continue;
        task.state = TaskState::kOver;
        for (size_t i = 0; i < task.leases.size(); ++i) {
          (task.crashed.contains(i) ? crashed : returned).push_back(task.leases[i]);
        }
      }
    }
  }
  for (const Lease& lease : returned) scheduler_.Return(lease, tried);
  for (const Lease& lease : crashed) scheduler_.ReturnCrashed(lease);
}

void SlurmExecutor::EndFinalTasks() {
  EndTasks([](const Task& task) { return task.is_final; }, true);
}

void SlurmExecutor::EndUnneededTasks() {
  EndTasks([](const Task& task) { return task.unneeded; }, false);
}

bool SlurmExecutor::IsNeeded(const Task& task) const {
  return std::ranges::any_of(task.leases,
                             [this](const Lease& lease) { return scheduler_.Needs(lease); });
}

// Empty if nothing is to be cancelled now. Some tasks can be cancelled only after a query.
std::optional<SlurmExecutor::Cancellation> SlurmExecutor::CancellationOf(const std::string& name,
                                                                         const Array& array) const {
  Cancellation cancellation = {.name = name};
  bool all = true;
  for (size_t i = 0; i < array.tasks.size(); ++i) {
    if (array.tasks[i].state == TaskState::kOver) continue;
    const bool is_needed = IsNeeded(array.tasks[i]);
    if (!is_needed) cancellation.tasks.insert(i);
    all = all && !is_needed;
  }
  if (!all) cancellation.id = array.id;
  const bool has_unreadable_tasks = array.tasks.empty() && array.submitted;
  const bool is_due = !cancellation.tasks.empty() && (all || !array.id.empty());
  return is_due || has_unreadable_tasks ? std::optional(cancellation) : std::nullopt;
}

void SlurmExecutor::DropUnneededTasks() {
  std::vector<Cancellation> cancellations;
  {
    MutexLock lock(mutex_);
    for (const auto& [name, array] : arrays_) {
      if (auto cancellation = CancellationOf(name, array)) {
        cancellations.push_back(*std::move(cancellation));
      }
    }
  }
  for (const Cancellation& cancellation : cancellations) Cancel(cancellation);
  EndUnneededTasks();
}

void SlurmExecutor::Cancel(const Cancellation& cancellation) {
  const auto& [name, id, tasks] = cancellation;
  const absl::Status cancelled = id.empty()
                                     ? tools_->Cancel(name, stop_.get_token())
                                     : tools_->CancelTasks(name, id, tasks, stop_.get_token());
  NoteOutcome(Activity::kQueue, cancelled);
  if (!cancelled.ok()) return;
  MutexLock lock(mutex_);
  Array& array = arrays_.at(name);
  for (const size_t task : tasks) array.tasks[task].unneeded = true;
  if (tasks.empty()) array.submitted = false;
}

void SlurmExecutor::QueryIfDue() {
  const Clock::time_point now = Clock::now();
  {
    MutexLock lock(mutex_);
    if (TasksInFlight() == 0 || now < last_query_ + options_.query_interval) return;
    last_query_ = now;
    ++counts_.queries;
  }
  const auto queue = tools_->Query(prefix_, stop_.get_token());
  if (stop_.stop_requested()) return;
  NoteOutcome(Activity::kQueue, queue.status());
  if (queue.ok()) NoteQueue(*queue, now);
}

void SlurmExecutor::NoteQueue(const std::map<std::string, QueuedArray>& queue,
                              Clock::time_point asked) {
  for (const std::string& name : ArrayNames()) {
    const auto queued = queue.find(name);
    NoteTasks(name, queued == queue.end() ? nullptr : &queued->second, asked);
  }
  for (const auto& [name, array] : queue) {
    if (!HasArray(name)) tools_->Cancel(name, stop_.get_token()).IgnoreError();  // retried later
  }
}

void SlurmExecutor::NoteTasks(const std::string& name, const QueuedArray* queued,
                              Clock::time_point asked) {
  static const QueuedArray kNone;
  const QueuedArray& now = queued != nullptr ? *queued : kNone;
  bool some_are_missing = false;
  {
    MutexLock lock(mutex_);
    Array& array = arrays_.at(name);
    if (!array.submitted || array.submit_time >= asked) return;
    array.id = now.id;
    for (size_t i = 0; i < array.tasks.size(); ++i) {
      Task& task = array.tasks[i];
      if (task.state == TaskState::kOver) continue;
      const bool waits = now.waiting.contains(i), runs = now.running.contains(i);
      task.missing = waits || runs ? 0 : task.missing + 1;
      if (waits) task.state = TaskState::kWaiting;
      if (runs) task.state = TaskState::kRunning;
      some_are_missing = some_are_missing || task.missing >= kMissingQueries;
    }
  }
  if (some_are_missing) EndLostTasks(name);
  const auto forever = std::ranges::find_if(now.reasons, WaitsForever);
  if (now.running.empty() && forever != now.reasons.end()) GiveUpWaiting(name, *forever);
}

void SlurmExecutor::NoteCrashes(const std::string& name, size_t index, Task& task) {
  for (size_t lease = 0; lease < task.leases.size(); ++lease) {
    if (!std::filesystem::exists(CrashMarkFile(folder_.PathOf(name), index, lease))) continue;
    task.crashed.insert(lease);
    LogError(absl::StrCat("slurm: the engine crashed in task ", index, " of ", name, ", attempt ",
                          task.leases[lease].attempt, " of point ", task.leases[lease].point));
  }
}

// First reads their files once more. A task that left the mark of a crash can use the folder.
void SlurmExecutor::EndLostTasks(const std::string& name) {
  CollectArray(name).IgnoreError();  // the thread that reads files meets the same error
  EndFinalTasks();
  size_t lost = 0, without_file = 0;
  {
    MutexLock lock(mutex_);
    std::vector<Task>& tasks = arrays_.at(name).tasks;
    for (size_t i = 0; i < tasks.size(); ++i) {
      Task& task = tasks[i];
      const bool is_lost = task.state != TaskState::kOver && !task.has_unread_file &&
                           task.missing >= kMissingQueries;
      if (!is_lost) continue;
      task.is_lost = true;
      NoteCrashes(name, i, task);
      ++lost;
      without_file += task.left_a_file || !task.crashed.empty() ? 0 : 1;
    }
    counts_.lost_tasks += static_cast<double>(lost);
  }
  if (lost == 0) return;
  LogInfo(absl::StrCat("slurm: ", lost, " tasks of ", name,
                       " ended without their last file; their chunks are computed again"));
  if (without_file == lost) {
    BackOff(absl::UnavailableError(
        absl::StrCat("tasks of ", name, " left no file in ", folder_.PathOf(name),
                     ": see the logs there, and whether the nodes share this folder")));
  }
  EndTasks([](const Task& task) { return task.is_lost; }, true);
}

void SlurmExecutor::GiveUpWaiting(const std::string& name, const std::string& reason) {
  BackOff(
      absl::UnavailableError(absl::StrCat("tasks of ", name, " would wait for ever: ", reason)));
  if (!tools_->Cancel(name, stop_.get_token()).ok()) return;  // retried after the next query
  EndArray(name);
}

// Ends an array that Slurm does not have: its leases go back to the scheduler.
void SlurmExecutor::EndArray(const std::string& name) {
  {
    MutexLock lock(mutex_);
    for (Task& task : arrays_.at(name).tasks) task.unneeded = true;
  }
  EndUnneededTasks();
}

void SlurmExecutor::BackOff(const absl::Status& problem) {
  NoteOutcome(Activity::kSubmission, problem);
  MutexLock lock(mutex_);
  const auto first = std::min<std::chrono::milliseconds>(kFirstBackoff, options_.query_interval);
  backoff_ = std::clamp<std::chrono::milliseconds>(2 * backoff_, first, kLongestBackoff);
  next_submission_ = Clock::now() + backoff_;
}

// ---- submission ----

void SlurmExecutor::SubmitNew() {
  const size_t room = RoomForTasks();
  if (room == 0) return ReturnGathered();
  const bool is_full = Gather(static_cast<double>(room) * capacity_.seconds);
  if (gathered_.empty()) return;
  if (!is_full && ++looks_at_gathered_ < kGatherLooks) return;
  looks_at_gathered_ = 0;
  const absl::StatusOr<std::string> worker = PreparedWorker();
  if (!worker.ok()) {
    BackOff(worker.status());
    return ReturnGathered();
  }
  for (auto& [run, leases] : std::exchange(gathered_, {})) {
    SubmitRun(*worker, std::move(leases));
  }
}

// 0 while nothing is to be submitted. After a failure, one task.
size_t SlurmExecutor::RoomForTasks() const {
  MutexLock lock(mutex_);
  if (stop_.stop_requested() || Clock::now() < next_submission_) return 0;
  const size_t in_flight = TasksInFlight();
  if (backoff_.count() > 0) return in_flight == 0 ? 1 : 0;
  return options_.max_tasks - std::min(in_flight, options_.max_tasks);
}

// Gives the gathered leases back, so that the server's threads can take them.
void SlurmExecutor::ReturnGathered() {
  for (const auto& [run, leases] : std::exchange(gathered_, {})) ReturnUntried({leases});
  looks_at_gathered_ = 0;
}

absl::StatusOr<std::string> SlurmExecutor::PreparedWorker() const {
  const absl::Status prepared = folder_.Prepare();
  if (!prepared.ok()) return prepared;
  return folder_.CopyWorker(options_.worker.empty() ? InstalledWorker() : options_.worker);
}

// True if there is work of so many seconds.
bool SlurmExecutor::Gather(double seconds) {
  double gathered = 0;
  for (const auto& [run, leases] : gathered_) gathered += SecondsOf(leases);
  {
    MutexLock lock(mutex_);
    capacity_.memory = node_memory_;
  }
  while (gathered < seconds) {
    std::optional<Lease> lease = scheduler_.Next(capacity_);
    if (!lease) return false;
    gathered += lease->seconds;
    gathered_[lease->run].push_back(*std::move(lease));
  }
  return true;
}

void SlurmExecutor::SubmitRun(const std::string& worker, std::vector<Lease> leases) {
  std::vector<std::vector<Lease>> tasks;
  for (Lease& lease : leases) {
    if (!scheduler_.Needs(lease)) continue;
    if (tasks.empty() || SecondsOf(tasks.back()) + lease.seconds / 2 > capacity_.seconds) {
      if (tasks.size() == array_size_) SubmitArray(worker, std::exchange(tasks, {}));
      tasks.emplace_back();
    }
    tasks.back().push_back(std::move(lease));
  }
  if (!tasks.empty()) SubmitArray(worker, std::move(tasks));
}

void SlurmExecutor::SubmitArray(const std::string& worker, std::vector<std::vector<Lease>> tasks) {
  if (RoomForTasks() == 0) return ReturnUntried(tasks);  // Slurm rejected an earlier array
  const std::string name = NewName();
  const absl::Status made = folder_.MakeArray(name);
  const absl::Status written = made.ok() ? WriteArray(name, tasks) : made;
  if (!written.ok()) {
    if (made.ok()) folder_.RemoveArray(name);
    ReturnUntried(tasks);
    return BackOff(written);
  }
  Array array;
  for (std::vector<Lease>& leases : tasks) {
    array.tasks.push_back({.leases = std::move(leases)});
  }
  ArraySubmission submission = {.name = name,
                                .tasks = array.tasks.size(),
                                .folder = folder_.PathOf(name),
                                .command = {worker, "--task-file", TaskFileIn(folder_.PathOf(name)),
                                            "--out", folder_.PathOf(name)}};
  {
    MutexLock lock(mutex_);
    arrays_.emplace(name, std::move(array));
  }
  Failpoint("slurm.tasks_written");
  const absl::Status submitted = tools_->Submit(submission, stop_.get_token());
  Failpoint("slurm.submitted");
  NoteSubmission(name, submitted);
}

absl::Status SlurmExecutor::WriteArray(const std::string& name,
                                       const std::vector<std::vector<Lease>>& tasks) const {
  std::vector<std::vector<IdentifiedLease>> identified;
  for (const std::vector<Lease>& leases : tasks) {
    std::vector<IdentifiedLease>& of_task = identified.emplace_back();
    for (const Lease& lease : leases) of_task.push_back({IdentityOf(lease), lease});
  }
  return WriteTaskFile(TaskFileIn(folder_.PathOf(name)), name, identified);
}

void SlurmExecutor::NoteSubmission(const std::string& name, const absl::Status& submitted) {
  if (submitted.ok() || absl::IsUnknown(submitted)) {
    NoteOutcome(Activity::kSubmission, submitted);
    MutexLock lock(mutex_);
    Array& array = arrays_.at(name);
    array.submitted = true;
    array.submit_time = Clock::now();
    return;
  }
  const bool is_too_large = absl::StrContains(submitted.message(), "Invalid job array");
  if (is_too_large && array_size_ > 1) {
    array_size_ /= 2;
    NoteOutcome(Activity::kSubmission, absl::UnavailableError(absl::StrCat(
                                           submitted.message(), "; arrays now have ", array_size_,
                                           " tasks: set --slurm-max-array-size")));
  } else {
    BackOff(submitted);
  }
  EndArray(name);
}

void SlurmExecutor::ReturnUntried(const std::vector<std::vector<Lease>>& tasks) {
  for (const std::vector<Lease>& leases : tasks) {
    for (const Lease& lease : leases) scheduler_.Return(lease, false);
  }
}

std::string SlurmExecutor::NewName() {
  std::random_device random;
  return absl::StrFormat("%s%08x", prefix_, random());
}

// Removes a folder when all chunks that were read from it are on disk.
void SlurmExecutor::RemoveEnded() {
  std::vector<std::string> ended;
  {
    MutexLock lock(mutex_);
    for (const auto& [name, array] : arrays_) {
      const bool over = std::ranges::all_of(
          array.tasks, [](const Task& task) { return task.state == TaskState::kOver; });
      const bool to_be_cancelled = array.tasks.empty() && array.submitted;
      if (over && !to_be_cancelled) ended.push_back(name);
    }
  }
  if (ended.empty()) return;
  { MutexLock files_being_reported(collect_mutex_); }  // waits for them before the flush
  if (!flush_().ok()) return;
  for (const std::string& name : ended) {
    MutexLock one_at_a_time(collect_mutex_);
    folder_.RemoveArray(name);
    MutexLock lock(mutex_);
    arrays_.erase(name);
  }
}

// ---- status ----

size_t SlurmExecutor::TasksInFlight() const {
  size_t tasks = 0;
  for (const auto& [name, array] : arrays_) {
    tasks += static_cast<size_t>(std::ranges::count_if(
        array.tasks, [](const Task& task) { return task.state != TaskState::kOver; }));
  }
  return tasks;
}

SlurmStatus SlurmExecutor::Status() const {
  MutexLock lock(mutex_);
  SlurmStatus status = counts_;
  for (const std::string& problem : problems_) {
    if (problem.empty()) continue;
    absl::StrAppend(&status.problem, status.problem.empty() ? "" : "; ", problem);
  }
  for (const auto& [name, array] : arrays_) {
    for (const Task& task : array.tasks) {
      status.waiting_tasks += task.state == TaskState::kWaiting;
      status.running_tasks += task.state == TaskState::kRunning;
      status.submitted_tasks += task.state == TaskState::kUnknown;
    }
  }
  return status;
}

}  // namespace ballpiston::server
