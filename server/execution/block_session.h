// A session computes blocks of one point in turns of about 50 ms. Between turns the session keeps
// its orbits where they are, and any worker may take the next turn.
//
// The worker that has the session calls Advance; the session gets blocks from `BlockExchange`.
#ifndef BALLPISTON_SERVER_EXECUTION_BLOCK_SESSION_H_
#define BALLPISTON_SERVER_EXECUTION_BLOCK_SESSION_H_

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>

#include "core/ensemble/block_run.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

class Run;

// Hands out the blocks of a run's points and receives their results. Thread-safe.
class BlockExchange {
 public:
  virtual ~BlockExchange() = default;
  virtual std::optional<Block> NextBlock(Run& run, size_t point) = 0;
  // `seconds`: processor time since the session's turn began or its previous block was done.
  virtual void BlockDone(Run& run, size_t point, const Block& block, BlockResult result,
                         double seconds) = 0;
  // Called at the end of a turn; `seconds` as in BlockDone.
  virtual void TurnEnds(Run& run, size_t point, double seconds) = 0;
};

class BlockSession : private BlockQueue {
 public:
  // The exchange and the run must outlive the session.
  BlockSession(BlockExchange& exchange, Run& run, size_t point,
               std::shared_ptr<const PointExperiment> experiment, std::stop_token stop);

  // Runs one turn. False if the session has no work left or was stopped; it can be destroyed then.
  bool Advance();

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<Block> Next() override;
  void Done(const Block& block, BlockResult result) override;
  bool Pause() override;
  std::stop_token stop() const override { return stop_; }

  BlockExchange& exchange_;
  Run& run_;
  const size_t point_;
  const std::shared_ptr<const PointExperiment> experiment_;
  const std::stop_token stop_;
  Clock::time_point end_of_turn_;
  double worked_ = 0;  // the thread's processor time at the last report
  std::unique_ptr<BlockRun> blocks_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_BLOCK_SESSION_H_
