#include "server/worker/lease_runner.h"

#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "core/ensemble/block_run.h"
#include "core/ensemble/point_fold.h"
#include "server/processor_time.h"

namespace ballpiston::server {
namespace {

class LeaseRun : private BlockQueue {
 public:
  LeaseRun(const Lease& lease, const std::stop_token& stop, ChunkReceiver& receiver)
      : lease_(lease),
        stop_(stop),
        receiver_(receiver),
        chunks_(lease.experiment->plan(), lease.start, lease.end, lease.groups) {
    if (lease.start.chunk == 0) judge_.emplace(*lease.experiment);
  }

  bool Run() {
    const std::unique_ptr<EngineRun> run = lease_.experiment->StartRun(*this);
    while (!IsFinished() && !stop_.stop_requested()) run->Advance();
    TellWork();
    return IsFinished();
  }

 private:
  bool HasReachedItsTolerance() const { return judge_ && judge_->finished(); }
  bool IsFinished() const { return chunks_.finished() || HasReachedItsTolerance(); }

  void TellWork() {
    const double now = ThreadSeconds();
    receiver_.Worked(now - std::exchange(worked_, now));
  }

  std::optional<Block> Next() override {
    return HasReachedItsTolerance() ? std::nullopt : chunks_.NextBlock();
  }

  void Done(const Block& block, BlockResult result) override {
    for (ChunkResult& chunk : chunks_.Add(block, std::move(result))) {
      if (HasReachedItsTolerance()) return;
      if (judge_) judge_->Add(chunk);
      receiver_.ChunkDone(std::move(chunk));
      TellWork();
    }
  }

  bool Pause() override {
    TellWork();
    return HasReachedItsTolerance() || stop_.stop_requested();
  }

  std::stop_token stop() const override { return stop_; }

  const Lease& lease_;
  const std::stop_token& stop_;
  ChunkReceiver& receiver_;
  ChunkFold chunks_;
  std::optional<PointFold> judge_;   // of a lease that begins with chunk 0
  double worked_ = ThreadSeconds();  // the thread's processor time when it was last told
};

}  // namespace

bool RunLease(const Lease& lease, const std::stop_token& stop, ChunkReceiver& receiver) {
  return LeaseRun(lease, stop, receiver).Run();
}

}  // namespace ballpiston::server
