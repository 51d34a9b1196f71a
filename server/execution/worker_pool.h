// The threads that compute. They serve all active runs with fair shares and merge blocks in order.
//
// A worker takes a task from the run whose turn it is (fair_share.h), or from the next run if that
// run has no task now. It computes blocks of one point for one turn without a lock, and merges them
// under the pool's lock. An exception from a block ends only the block's run, with a failure.
// Results do not depend on the number of workers or on the order of turns. Thread-safe.
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

#include "server/execution/block_session.h"
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

// Totals since the pool was made, except for the first two members.
struct PoolCounts {
  int workers = 0;
  int busy = 0;  // now
  double blocks = 0;
  double samples = 0;
  double processor_seconds = 0;
};

class WorkerPool : private BlockExchange {
 public:
  WorkerPool(int workers, ExperimentFactory factory);
  ~WorkerPool() override;  // shuts down

  void Add(RunRequest request);

  // The run's journal then receives Ended(CANCELLED), unless the run is over already.
  void Cancel(int64_t key);

  // Stops the blocks in progress, joins the threads, and writes checkpoints of unfinished runs to
  // their journals, so that a later process can resume them. May be called more than once.
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
  // Resumes the point from the checkpoint of an earlier process, if there is one.
  absl::Status Resume(Run& run, size_t point, OpenPoint& open);
  // Runs one turn. Sets `resting` to the session if the session has more work.
  absl::Status Advance(Run& run, const SessionTask& task, std::shared_ptr<BlockSession>& resting);

  std::optional<Block> NextBlock(Run& run, size_t point) override;
  void BlockDone(Run& run, size_t point, const Block& block, BlockResult result,
                 double seconds) override;
  void TurnEnds(Run& run, size_t point, double seconds) override;

  // Requires the lock. Returns whether the point is finished; if not, may write a checkpoint.
  bool CameToItsEnd(Run& run, size_t point, OpenPoint& open);
  void WriteCheckpoints(Run& run);
  // Requires the lock. A point whose budget is spent ends if it has a merged block.
  void EndIfBudgetIsSpent(Run& run, size_t point, OpenPoint& open);
  void ClosePoint(Run& run, size_t point);
  void Conclude(const std::shared_ptr<Run>& run);

  const ExperimentFactory factory_;
  const int workers_;

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
