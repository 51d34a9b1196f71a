// A session computes blocks of a lease in turns of about 50 ms. Between turns the session keeps its
// orbits where they are, and any thread may take the next turn.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>

#include "core/ensemble/block_run.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

// Hands out blocks of a lease and receives their results. Thread-safe.
class BlockExchange {
 public:
  virtual ~BlockExchange() = default;
  virtual std::optional<Block> NextBlock() = 0;
  // `seconds`: processor time since the session's turn began or its previous block was done.
  virtual void BlockDone(const Block& block, BlockResult result, double seconds) = 0;
  // At the end of a turn; `seconds` as in BlockDone.
  virtual void TurnEnds(double seconds) = 0;
};

class BlockSession : private BlockQueue {
 public:
  // The exchange and the device must outlive the session. `device` may be null (BlockQueue).
  BlockSession(BlockExchange& exchange, std::shared_ptr<const PointExperiment> experiment,
               std::stop_token stop, OrbitDevice* device = nullptr);

  // Runs one turn. False if the session has no work left or was stopped; it can be destroyed then.
  bool Advance();

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<Block> Next() override { return exchange_.NextBlock(); }
  void Done(const Block& block, BlockResult result) override;
  bool Pause() override;
  OrbitDevice* device() const override { return device_; }
  std::stop_token stop() const override { return stop_; }

  BlockExchange& exchange_;
  const std::shared_ptr<const PointExperiment> experiment_;
  const std::stop_token stop_;
  OrbitDevice* const device_;
  Clock::time_point end_of_turn_;
  double worked_ = 0;  // the thread's processor time at the last report
  std::unique_ptr<EngineRun> blocks_;
};

}  // namespace ballpiston::server
