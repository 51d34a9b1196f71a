#include "server/worker/task_run.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>
#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/strings/str_cat.h"
#include "core/ensemble/experiment_kind.h"
#include "server/status/failpoint.h"
#include "server/worker/chunk_file.h"
#include "server/worker/crash_mark.h"
#include "server/worker/lease_runner.h"

namespace ballpiston::server {
namespace {

class TaskRun : private ChunkReceiver {
 public:
  TaskRun(const ArrayTask& task, const TaskRunOptions& options, std::stop_source stop,
          const Report& report);

  absl::Status Run();

 private:
  // ---- files of an earlier run ----
  absl::Status ReadKnown();
  void TakeFile(const ChunkFile& file);
  void TakeChunks(const LeaseChunks& chunks);

  // ---- new files ----
  bool LeaseBegins(size_t lease) override;
  void ChunkDone(size_t lease, ChunkResult chunk) override;
  void Worked(size_t lease, double seconds) override;
  bool HasNewChunks() const;
  void StartFile();
  absl::Status Write(bool is_final);
  absl::Status WriteOnce();
  // Again while the folder is full or cannot be used, but not for ever.
  absl::Status Retried(absl::FunctionRef<absl::Status()> attempt);

  const ArrayTask& task_;
  const TaskRunOptions& options_;
  std::stop_source stop_;
  const Report& report_;
  std::vector<LeaseWork> work_;
  bool was_final_ = false;  // an earlier run had nothing left to compute
  ChunkFile next_;          // the next file
  double since_file_ = 0;   // processor time
  absl::Status failed_;
};

TaskRun::TaskRun(const ArrayTask& task, const TaskRunOptions& options, std::stop_source stop,
                 const Report& report)
    : task_(task), options_(options), stop_(std::move(stop)), report_(report) {
  for (const IdentifiedLease& lease : task_.leases) work_.push_back({.lease = lease.lease});
  next_ = {.array = task_.array, .task = task_.task};
  StartFile();
}

absl::Status TaskRun::Run() {
  absl::Status status = Retried([&] { return ReadKnown(); });
  if (!status.ok()) return status;
  const bool is_finished = RunLeases(work_, stop_.get_token(), *this);
  if (!failed_.ok()) return failed_;
  const bool has_news = HasNewChunks() || (is_finished && !was_final_);
  return has_news ? Write(is_finished) : absl::OkStatus();
}

absl::Status TaskRun::ReadKnown() {
  const absl::StatusOr<std::vector<ChunkFileName>> names = ListChunkFiles(options_.folder);
  if (!names.ok()) return names.status();
  for (const ChunkFileName& name : *names) {
    if (name.task != task_.task) continue;
    next_.sequence = name.sequence + 1;
    const absl::StatusOr<ChunkFile> file = ReadChunkFile(options_.folder, name);
    if (file.ok()) {
      TakeFile(*file);
    } else {
      report_(absl::StrCat(file.status().message(), "; its chunks are computed again"));
    }
  }
  return absl::OkStatus();
}

void TaskRun::TakeFile(const ChunkFile& file) {
  if (file.array != task_.array) {
    return report_(absl::StrCat("sequence ", file.sequence, " is a file of array ", file.array,
                                ", not of array ", task_.array, "; it is not used"));
  }
  was_final_ |= file.is_final;
  for (const LeaseChunks& chunks : file.leases) TakeChunks(chunks);
}

void TaskRun::TakeChunks(const LeaseChunks& chunks) {
  const absl::Status checked =
      chunks.lease < work_.size()
          ? CheckLeaseChunks(task_.leases[chunks.lease], chunks)
          : absl::DataLossError(absl::StrCat("the task has no lease ", chunks.lease));
  if (!checked.ok()) {
    return report_(absl::StrCat(checked.message(), "; these chunks are computed again"));
  }
  std::vector<ChunkResult>& known = work_[chunks.lease].known;
  known.insert(known.end(), chunks.chunks.begin(), chunks.chunks.end());
}

bool TaskRun::LeaseBegins(size_t index) {
  const Lease& lease = work_[index].lease;
  const double needed = MemoryOf(*lease.spec, lease.experiment->parameters(), 1);
  if (needed > options_.memory) {
    report_(absl::StrCat("lease ", index, " needs ", needed,
                         " bytes of memory, but this task may use ", options_.memory,
                         ": it is left out"));
    next_.memory_exceeded = options_.memory;
    return false;
  }
  SetCrashMark(options_.folder, task_.task, index);
  CrashForSeed(lease.spec->seed);
  return true;
}

void TaskRun::ChunkDone(size_t lease, ChunkResult chunk) {
  next_.leases[lease].chunks.push_back(std::move(chunk));
}

void TaskRun::Worked(size_t lease, double seconds) {
  next_.leases[lease].processor_seconds += seconds;
  since_file_ += seconds;
  if (since_file_ < options_.flush_seconds || !HasNewChunks() || !failed_.ok()) return;
  failed_ = Write(false);
  if (!failed_.ok()) stop_.request_stop();
}

bool TaskRun::HasNewChunks() const {
  return std::any_of(next_.leases.begin(), next_.leases.end(),
                     [](const LeaseChunks& lease) { return !lease.chunks.empty(); });
}

void TaskRun::StartFile() {
  next_.leases.clear();
  for (size_t i = 0; i < task_.leases.size(); ++i) {
    const auto& [job, lease] = task_.leases[i];
    next_.leases.push_back(
        {.lease = i, .job = job, .point = lease.point, .attempt = lease.attempt});
  }
  since_file_ = 0;
}

absl::Status TaskRun::Write(bool is_final) {
  next_.is_final = is_final;
  absl::Status written = Retried([&] { return WriteOnce(); });
  if (!written.ok()) return written;
  report_(absl::StrCat("wrote ", ChunkFileName{next_.task, next_.sequence}.Text(),
                       is_final ? ", the final file" : ""));
  ++next_.sequence;
  StartFile();
  return absl::OkStatus();
}

// Another process may run the same task: one that the job scheduler takes for dead. Its files stay.
absl::Status TaskRun::WriteOnce() {
  absl::Status written = WriteChunkFile(options_.folder, next_);
  while (absl::IsAlreadyExists(written)) {
    ++next_.sequence;
    written = WriteChunkFile(options_.folder, next_);
  }
  return written;
}

absl::Status TaskRun::Retried(absl::FunctionRef<absl::Status()> attempt) {
  double waited = 0;
  while (true) {
    absl::Status status = attempt();
    const bool may_pass = absl::IsUnavailable(status) || absl::IsResourceExhausted(status);
    if (!may_pass || waited >= options_.give_up_seconds) return status;
    report_(absl::StrCat(status.message(), "; retry in ", options_.retry_seconds, " s"));
    std::this_thread::sleep_for(std::chrono::duration<double>(options_.retry_seconds));
    waited += options_.retry_seconds;
  }
}

}  // namespace

absl::Status RunTask(const ArrayTask& task, const TaskRunOptions& options, std::stop_source stop,
                     const Report& report) {
  return TaskRun(task, options, std::move(stop), report).Run();
}

}  // namespace ballpiston::server
