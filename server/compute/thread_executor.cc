#include "server/compute/thread_executor.h"

#include <chrono>
#include <deque>
#include <optional>
#include <stop_token>
#include <utility>

#include "absl/status/status.h"
#include "core/ensemble/block_run.h"
#include "core/ensemble/chunk_fold.h"
#include "server/compute/guarded.h"
#include "server/mutex.h"
#include "server/status/failpoint.h"

namespace ballpiston::server {
namespace {

constexpr std::chrono::milliseconds kTurn(50);

}  // namespace

// A lease at which several threads take turns.
class ThreadExecutor::SharedLease : public SharedWork {
 public:
  SharedLease(ThreadExecutor& executor, Lease lease)
      : executor_(executor),
        lease_(std::move(lease)),
        fold_(lease_.experiment->plan(), lease_.start, lease_.end, lease_.groups) {}

  bool IsStopped() const { return lease_.stop.stop_requested(); }

  // While the lease is ending and no block is in progress, one more turn reports this.
  bool HasTurn() const override {
    MutexLock lock(mutex_);
    return !resting_.empty() || HasNextBlock() || (fold_.handed_out() == 0 && fold_.HasNextBlock());
  }

  // One turn, in the session that has rested longest, or in a new one.
  void Advance() {
    std::unique_ptr<Session> session = TakeSession();
    const bool has_more = session->Advance();
    MutexLock lock(mutex_);
    if (has_more) resting_.push_back(std::move(session));
    if (!has_more) --sessions_;
  }

 private:
  // Computes blocks of the lease in turns of about 50 ms (block_run.h). Between turns it keeps its
  // orbits where they are, and any thread may take the next turn.
  class Session : private BlockQueue {
   public:
    explicit Session(SharedLease& lease) : lease_(lease) {}

    // Runs one turn. False if the session has no work left or was stopped; it can be destroyed
    // then.
    bool Advance() {
      end_of_turn_ = SteadyNow() + kTurn;
      worked_ = ProcessorSeconds();
      if (blocks_ == nullptr) blocks_ = lease_.lease_.experiment->StartRun(*this);
      const bool is_idle = blocks_->Advance();
      lease_.TurnEnds(TakeSeconds());
      return !is_idle && !lease_.IsStopped();
    }

   private:
    // Of processor time, since the turn began or its previous block was done.
    double TakeSeconds() {
      const double now = ProcessorSeconds();
      return now - std::exchange(worked_, now);
    }

    std::optional<Block> Next() override { return lease_.NextBlock(); }
    void Done(const Block& block, BlockResult result) override {
      lease_.BlockDone(block, std::move(result), TakeSeconds());
    }
    bool Pause() override { return lease_.IsStopped() || SteadyNow() >= end_of_turn_; }
    OrbitDevice* device() const override { return lease_.executor_.device_; }
    std::stop_token stop() const override { return lease_.lease_.stop; }

    SharedLease& lease_;
    std::chrono::steady_clock::time_point end_of_turn_;
    double worked_ = 0;  // the thread's processor time at the last report
    std::unique_ptr<EngineRun> blocks_;
  };

  // Room for the blocks that the sessions have in progress (LeaseMemory).
  uint64_t Window() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    const OrbitDevice* const device = executor_.device_;
    const uint64_t further = (sessions_ - 1) * ChunkFold::kOrbitsOfAThread;
    return ChunkFold::WindowFor(lease_.experiment->plan(), device ? device->orbits() : further);
  }

  std::unique_ptr<Session> TakeSession() {
    MutexLock lock(mutex_);
    if (resting_.empty()) {
      ++sessions_;
      fold_.WidenTo(Window());
      return std::make_unique<Session>(*this);
    }
    std::unique_ptr<Session> session = std::move(resting_.front());
    resting_.pop_front();
    return session;
  }

  bool HasNextBlock() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return !lease_.ending.stop_requested() && fold_.HasNextBlock();
  }

  std::optional<Block> NextBlock() {
    MutexLock lock(mutex_);
    return IsStopped() || !HasNextBlock() ? std::nullopt : fold_.NextBlock();
  }

  void BlockDone(const Block& block, BlockResult result, double seconds) {
    executor_.blocks_.fetch_add(1, std::memory_order_relaxed);
    LeaseReport report;
    bool has_room = false;
    {
      MutexLock lock(mutex_);
      const bool was_full = !HasNextBlock();
      std::vector<ChunkResult> complete = fold_.Add(block, std::move(result));
      report = {std::move(complete), fold_.partial(), seconds, fold_.handed_out()};
      has_room = was_full && HasNextBlock();
    }
    executor_.scheduler_.Report(lease_, std::move(report)).IgnoreError();  // of chunks elsewhere
    if (has_room) executor_.scheduler_.Wake();
  }

  void TurnEnds(double seconds) {
    LeaseReport report = {.seconds = seconds};
    {
      MutexLock lock(mutex_);
      report.partial = fold_.partial();
      report.begun = fold_.handed_out();
    }
    executor_.scheduler_.Report(lease_, std::move(report)).IgnoreError();  // of chunks elsewhere
  }

  ThreadExecutor& executor_;
  const Lease lease_;
  mutable Mutex mutex_;
  ChunkFold fold_ ABSL_GUARDED_BY(mutex_);
  std::deque<std::unique_ptr<Session>> resting_ ABSL_GUARDED_BY(mutex_);
  uint64_t sessions_ ABSL_GUARDED_BY(mutex_) = 0;  // also those that rest
};

ThreadExecutor::ThreadExecutor(Scheduler& scheduler, int threads, double seconds,
                               std::shared_ptr<CrashRecord> crashes, OrbitDevice* device)
    : scheduler_(scheduler),
      workers_(threads),
      crashes_(std::move(crashes)),
      device_(device),
      capacity_{
          .share =
              [this](const Lease& lease) { return std::make_shared<SharedLease>(*this, lease); },
          .waits = true,
          .seconds = seconds} {}

void ThreadExecutor::Start() {
  for (int i = 0; i < workers_; ++i) threads_.emplace_back([this] { Work(); });
}

ThreadExecutor::~ThreadExecutor() {
  scheduler_.Shutdown();
  for (Thread& thread : threads_) thread.join();
}

void ThreadExecutor::Work() {
  while (const std::optional<Lease> lease = scheduler_.Next(capacity_)) TakeTurn(*lease);
}

void ThreadExecutor::TakeTurn(const Lease& lease) {
  busy_.fetch_add(1, std::memory_order_relaxed);
  std::optional<CrashRecord::Entry> failed;
  const double start = ProcessorSeconds();
  Compute(lease, failed);
  const double seconds = ProcessorSeconds() - start;
  busy_.fetch_sub(1, std::memory_order_relaxed);
  scheduler_.EndTurn(lease, seconds);
}

// The record has the point only here, not while EndTurn waits for the disk; if the turn fails,
// until EndTurn has reported this, which takes memory.
void ThreadExecutor::Compute(const Lease& lease, std::optional<CrashRecord::Entry>& computing) {
  const RunName run = {lease.run, lease.generation};
  for (const size_t point : lease.opens) {
    const CrashRecord::Entry opening(*crashes_, run, point);
    scheduler_.Open(lease, point);
  }
  if (lease.OpensPoints()) return;
  computing.emplace(*crashes_, run, lease.point);
  CrashForSeed(lease.spec->seed);
  const absl::Status advanced = Guarded(lease.point, [&] {
    static_cast<SharedLease&>(*lease.work).Advance();
    return absl::OkStatus();
  });
  if (!advanced.ok()) return scheduler_.Stop(lease.run, advanced);
  computing.reset();
}

}  // namespace ballpiston::server
