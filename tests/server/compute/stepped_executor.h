// A local executor without threads: the test takes its turns, so a schedule can be repeated.
#pragma once

#include "server/compute/guarded.h"
#include "server/compute/scheduler.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {

class SteppedExecutor : public Executor {
 public:
  explicit SteppedExecutor(Scheduler& scheduler)
      : scheduler_(scheduler), capacity_{.executor = scheduler.AddExecutor(*this)} {}

  ~SteppedExecutor() override { scheduler_.RemoveExecutor(capacity_.executor); }

  void Wake() override {}
  bool HasTurn(int64_t lease) const override {
    const auto found = folds_.find(lease);
    return found != folds_.end() && found->second.HasNextBlock();
  }
  void Shutdown() override { is_shut_down_ = true; }

  // Begins a turn; empty if there is no lease now.
  std::optional<Lease> Begin() { return is_shut_down_ ? std::nullopt : scheduler_.Next(capacity_); }

  // Opens the points of the lease, or computes at most `blocks` blocks of it. Ends the turn, which
  // took `seconds`.
  void End(const Lease& lease, uint64_t blocks, double seconds = 0) {
    for (const size_t point : lease.opens) scheduler_.Open(lease, point);
    if (!lease.OpensPoints()) Compute(lease, blocks);
    if (!scheduler_.EndTurn(lease, seconds)) folds_.erase(lease.number);
  }

  // A turn; false if there is no lease now.
  bool TakeTurn(uint64_t blocks = std::numeric_limits<uint64_t>::max(), double seconds = 0) {
    const std::optional<Lease> lease = Begin();
    if (lease) End(*lease, blocks, seconds);
    return lease.has_value();
  }

  void TakeAllTurns() {
    while (TakeTurn()) {
    }
  }

 private:
  void Compute(const Lease& lease, uint64_t blocks) {
    const PointExperiment& experiment = *lease.experiment;
    ChunkFold& fold =
        folds_.try_emplace(lease.number, experiment.plan(), lease.start, lease.end).first->second;
    const absl::Status computed = Guarded(lease.point, [&] {
      while (blocks-- > 0 && !lease.stop.stop_requested()) {
        const std::optional<Block> block = fold.NextBlock();
        if (!block) break;
        LeaseReport report = {.chunks = fold.Add(*block, *RunBlock(experiment, *block)),
                              .partial = fold.partial(),
                              .seconds = kSecondsOfABlock};
        const absl::Status taken = scheduler_.Report(lease, std::move(report));
        if (!taken.ok()) return taken;
      }
      return absl::OkStatus();
    });
    if (!computed.ok()) scheduler_.Stop(lease.run, computed);
  }

  // Without work there is nothing to write at a shutdown.
  static constexpr double kSecondsOfABlock = 1e-3;

  Scheduler& scheduler_;
  const Capacity capacity_;
  bool is_shut_down_ = false;
  std::map<int64_t, ChunkFold> folds_;  // by lease
};

}  // namespace ballpiston::server
