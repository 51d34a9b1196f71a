// Experiments that a test can stop, make fail and count.
#pragma once

#include "core/ensemble/point_fold.h"
#include "tests/server/factory_opener.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// Threads that pass the gate wait until it is opened or their stop is requested.
class Gate {
 public:
  void Open() {
    std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void Pass(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, stop, [this] { return open_; });
    --waiting_;
  }
  // Returns when that many wait at the closed gate.
  void AwaitWaiting(int count) {
    std::unique_lock lock(mutex_);
    AwaitNotified(changed_, lock, [&] { return waiting_ >= count; });
  }
  int waiting() {
    std::lock_guard lock(mutex_);
    return waiting_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool open_ = false;
  int waiting_ = 0;
};

// Called at the start of each block. If it throws, the block throws the same exception.
using BeforeBlock = std::function<void(size_t point, uint64_t block, std::stop_token stop)>;

inline constexpr uint64_t kFakeSamplesPerBlock = 2;

// Cheap blocks of kFakeSamplesPerBlock pseudo-random numbers in (0, 1), a function of seed, point
// and block alone. The spec's samples or collisions count blocks here; a tolerance has 1000 blocks
// at most.
ExperimentFactory FakeExperiments(BeforeBlock before_block = nullptr);

// The same with the seed of the specification as an argument, which identifies the run.
using BeforeBlockOfSeed =
    std::function<void(uint64_t seed, size_t point, uint64_t block, std::stop_token stop)>;
ExperimentFactory FakeExperimentsBySeed(BeforeBlockOfSeed before_block);

// Fake experiments. Blocks with the number `first_block` or a greater one wait at the gate.
ExperimentFactory GatedExperiments(Gate& gate, uint64_t first_block = 0);

// One rho, `points` deltas, `blocks` blocks each.
EnsembleSpec FakeSpec(int points, int64_t blocks, uint64_t seed = 1);

// The state of a fake point after its first blocks, and what they give, merged in order.
FoldState FakeState(const EnsembleSpec& spec, size_t point, uint64_t blocks);
BlockResult FakeMerged(const EnsembleSpec& spec, size_t point, uint64_t blocks);

}  // namespace ballpiston::server
