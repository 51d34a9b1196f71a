// The threads that compute: they take blocks from all active runs, fairly, and merge them in order.
//
// A worker asks the run whose turn it is for a block (see fair_share.h), or, if that has none to
// hand out just now, the next; computes it without any lock, and merges it under the pool's lock.
// Whatever a block throws ends its run with a failure and nothing else. The numbers do not depend
// on how many workers there are, nor on whose turn it was when. Thread-safe.
#ifndef BALLPISTON_SERVER_EXECUTION_WORKER_POOL_H_
#define BALLPISTON_SERVER_EXECUTION_WORKER_POOL_H_

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "server/execution/fair_share.h"
#include "server/execution/run.h"

namespace ballpiston::server {

// An open point as it was at one moment.
struct LivePoint {
  size_t index = 0;
  uint64_t version = 0;
  std::shared_ptr<const PointExperiment> experiment;
  BlockResult merged;
};

// Since the pool was made, but for the first two.
struct PoolCounts {
  int workers = 0;
  int busy = 0;  // now
  double blocks = 0;
  double samples = 0;
  double processor_seconds = 0;
};

class WorkerPool {
 public:
  WorkerPool(int workers, ExperimentFactory factory);
  ~WorkerPool();  // shuts down

  void Add(RunRequest request);

  // Its journal's Ended(CANCELLED) follows, unless the run is over already.
  void Cancel(int64_t key);

  // Stops the blocks in flight and joins the threads. Unfinished runs are dropped without a word:
  // what they stored lets a later process go on. May be called more than once.
  void Shutdown();

  // Copies of the run's unfinished points that changed after `version`, newest first, at most
  // `limit`.
  std::vector<LivePoint> ChangedSince(int64_t key, uint64_t version, size_t limit) const;

  PoolCounts Counts() const;  // takes no lock

 private:
  struct Assignment {
    std::shared_ptr<Run> run;
    RunTask task;
    bool begins_run = false;
  };

  void Work();
  std::optional<Assignment> AwaitAssignment();
  std::optional<Assignment> ChooseLocked();

  void Execute(const Assignment& assignment);
  absl::Status OpenNewPoint(Run& run, const OpenPointTask& task);
  // Merges what an earlier process computed of the point.
  absl::Status RestoreBlocks(Run& run, size_t point, OpenPoint& open);
  absl::Status ComputeBlock(Run& run, const BlockTask& task);
  void MergeBlock(Run& run, const BlockTask& task, BlockResult result, double seconds);
  // The lock is held; a point with a merged block ends with what it has.
  void EndIfBudgetIsSpent(Run& run, size_t point, OpenPoint& open);
  void ClosePoint(Run& run, size_t point);
  void Conclude(const std::shared_ptr<Run>& run);

  const ExperimentFactory factory_;
  const int workers_;
  const uint64_t window_;

  std::atomic<int> busy_ = 0;
  std::atomic<uint64_t> blocks_ = 0;
  std::atomic<double> samples_ = 0;
  std::atomic<double> processor_seconds_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable work_may_exist_;
  bool shutting_down_ = false;
  std::map<int64_t, std::shared_ptr<Run>> runs_;
  FairShare fair_share_;
  std::vector<std::thread> threads_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_WORKER_POOL_H_
