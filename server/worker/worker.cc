#include "server/worker/worker.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/ensemble/block_run.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "server/status/failpoint.h"

namespace ballpiston::server {
namespace {

using Seconds = std::chrono::duration<double>;
using Clock = std::chrono::steady_clock;

// Between two looks for a lease, without one. The first look is random, because many workers may
// start at the same time.
constexpr double kFirstLook = 1, kLongestLook = 20;

Clock::duration InTicks(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
}

// Computes one lease that the worker has taken, and leaves its chunks in the lease's file. A lease
// that begins with chunk 0 ends when its complete chunks reach the tolerance of its experiment.
class LeaseWork : private BlockQueue {
 public:
  LeaseWork(SharedFiles& files, const WorkerOptions& options, const WorkerHost& host,
            LeaseFileName name, const LeaseFile& file)
      : files_(files),
        options_(options),
        host_(host),
        name_(std::move(name)),
        lease_(file.lease),
        between_touches_(InTicks(file.touch_seconds)),
        last_touch_(host.now()),
        chunks_(lease_.experiment->plan(), lease_.start, lease_.end, lease_.groups) {
    if (lease_.start.chunk == 0) judge_.emplace(*lease_.experiment);
  }

  absl::Status Run() {
    CrashForSeed(lease_.spec->seed);
    const std::unique_ptr<EngineRun> run = lease_.experiment->StartRun(*this);
    while (!IsFinished() && !stop_.stop_requested()) run->Advance();
    if (is_lost_) return absl::OkStatus();
    const Outcome outcome = IsFinished() ? Outcome::kFinished : Outcome::kReturned;
    absl::Status left = Retried([this] { return LeaveChunks(); });
    if (left.ok()) left = Retried([&] { return files_.Move(name_.Taken(), name_.Done(outcome)); });
    return absl::IsNotFound(left) ? absl::OkStatus() : left;
  }

 private:
  std::optional<Block> Next() override {
    return HasReachedItsTolerance() ? std::nullopt : chunks_.NextBlock();
  }

  void Done(const Block& block, BlockResult result) override {
    for (ChunkResult& chunk : chunks_.Add(block, std::move(result))) {
      if (HasReachedItsTolerance()) return;
      if (judge_) judge_->Add(chunk);
      report_.chunks.push_back(std::move(chunk));
      if (host_.end() != EndOfWork::kNotYet) stop_.request_stop();
      TouchIfDue();
    }
  }

  bool Pause() override {
    if (host_.end() == EndOfWork::kNow) stop_.request_stop();
    TouchIfDue();
    return HasReachedItsTolerance() || stop_.stop_requested();
  }

  std::stop_token stop() const override { return stop_.get_token(); }

  bool HasReachedItsTolerance() const { return judge_ && judge_->finished(); }
  bool IsFinished() const { return chunks_.finished() || HasReachedItsTolerance(); }

  void TouchIfDue() {
    if (is_lost_ || host_.now() - last_touch_ < between_touches_) return;
    last_touch_ = host_.now();
    const absl::Status touched = LeaveChunks(true);
    is_lost_ = absl::IsNotFound(touched);
    if (is_lost_) stop_.request_stop();
    if (!touched.ok()) host_.report(touched.message());
  }

  // Without chunks, touches the file if this is wanted.
  absl::Status LeaveChunks(bool touches = false) {
    if (report_.chunks.empty()) {
      return touches ? files_.Touch(name_.Taken()) : absl::OkStatus();
    }
    report_.seconds = host_.processor_seconds() - reported_seconds_;
    absl::Status left = files_.Append(name_.Taken(), BytesOf(report_));
    if (!left.ok()) return left;
    reported_seconds_ += report_.seconds;
    report_.chunks.clear();
    return left;
  }

  // Retries while the folder is full or cannot be used, for at most give_up_seconds. A wait may end
  // early, so the time is limited, not the number of attempts.
  absl::Status Retried(const std::function<absl::Status()>& attempt) const {
    const Clock::time_point last = host_.now() + InTicks(options_.give_up_seconds);
    while (true) {
      absl::Status status = attempt();
      const bool may_pass = absl::IsUnavailable(status) || absl::IsResourceExhausted(status);
      const bool is_over = host_.now() >= last || host_.end() == EndOfWork::kNow;
      if (!may_pass || is_over) return status;
      host_.report(absl::StrCat(status.message(), "; retry in ", options_.retry_seconds, " s"));
      host_.sleep(Seconds(options_.retry_seconds));
    }
  }

  SharedFiles& files_;
  const WorkerOptions& options_;
  const WorkerHost& host_;
  const LeaseFileName name_;
  const Lease& lease_;
  const Clock::duration between_touches_;
  Clock::time_point last_touch_;
  std::stop_source stop_;
  ChunkFold chunks_;
  std::optional<PointFold> judge_;  // of a lease that begins with chunk 0
  LeaseReport report_;              // not in the file yet
  // The thread's processor time that is in the file.
  double reported_seconds_ = host_.processor_seconds();
  bool is_lost_ = false;
};

class Worker {
 public:
  Worker(SharedFiles& files, const WorkerOptions& options, const WorkerHost& host)
      : files_(files), options_(options), host_(host) {}

  absl::Status Run() {
    double look = kFirstLook * Random();
    Clock::time_point last_work = host_.now();
    bool is_usable = true;
    while (host_.end() == EndOfWork::kNotYet) {
      const absl::StatusOr<bool> worked = TakeOne();
      const bool may_pass = worked.ok() || absl::IsUnavailable(worked.status()) ||
                            absl::IsResourceExhausted(worked.status());
      if (!may_pass) return worked.status();
      const bool was_usable = std::exchange(is_usable, worked.ok());
      if (was_usable && !is_usable) host_.report(worked.status().message());
      if (worked.ok() && *worked) {
        last_work = host_.now();
        look = kFirstLook;
        continue;
      }
      if (host_.now() - last_work >= InTicks(options_.idle_seconds)) return worked.status();
      host_.sleep(Seconds(std::min(look, options_.idle_seconds)));
      look = std::min(2 * look + kFirstLook * Random(), kLongestLook);
    }
    return absl::OkStatus();
  }

 private:
  double Random() const { return 0x1p-64 * static_cast<double>(host_.random_bits()); }

  // False if there is no lease to take.
  absl::StatusOr<bool> TakeOne() {
    absl::StatusOr<std::vector<std::string>> names = files_.List("todo");
    if (!names.ok()) return names.status();
    while (!names->empty()) {
      std::string& any = (*names)[host_.random_bits() % names->size()];
      const LeaseFileName name = {std::move(any), options_.name};
      any = std::move(names->back());
      names->pop_back();
      const absl::Status taken = files_.Move(name.Todo(), name.Taken());
      if (absl::IsNotFound(taken)) continue;  // another worker has it
      const absl::Status computed = taken.ok() ? Compute(name) : taken;
      return computed.ok() ? absl::StatusOr<bool>(true) : computed;
    }
    return false;
  }

  absl::Status Compute(const LeaseFileName& name) {
    const absl::StatusOr<std::string> bytes = files_.Read(name.Taken(), 0);
    if (absl::IsNotFound(bytes.status())) return absl::OkStatus();  // the server needs it no more
    if (!bytes.ok()) return Ended(name, Outcome::kReturned, bytes.status());
    absl::string_view rest = *bytes;
    const absl::StatusOr<LeaseFile> file = host_.read_lease(rest);
    if (absl::IsUnimplemented(file.status())) {
      files_.Move(name.Taken(), name.Todo()).IgnoreError();
      return file.status();
    }
    if (!file.ok()) return Ended(name, Outcome::kReturned, file.status());
    const Lease& lease = file->lease;
    const double needed = MemoryOf(*lease.spec, lease.experiment->parameters(), 1);
    if (needed > options_.memory) {
      return Ended(name, Outcome::kNoMemory,
                   absl::OutOfRangeError(absl::StrCat("a lease needs ", needed,
                                                      " bytes of memory; this worker may use ",
                                                      options_.memory)));
    }
    host_.lease_begins(name.Taken(), name.Done(Outcome::kCrashed));
    return LeaseWork(files_, options_, host_, name, *file).Run();
  }

  absl::Status Ended(const LeaseFileName& name, Outcome outcome, const absl::Status& why) {
    host_.report(absl::StrCat(name.lease, ": ", why.message()));
    const absl::Status moved = files_.Move(name.Taken(), name.Done(outcome));
    return absl::IsNotFound(moved) ? absl::OkStatus() : moved;
  }

  SharedFiles& files_;
  const WorkerOptions& options_;
  const WorkerHost& host_;
};

}  // namespace

absl::Status Work(SharedFiles& files, const WorkerOptions& options, const WorkerHost& host) {
  return Worker(files, options, host).Run();
}

}  // namespace ballpiston::server
