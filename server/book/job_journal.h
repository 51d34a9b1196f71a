// Stores the progress that a job's run reports, and updates the job's numbers in memory.
//
// Order in the store: a checkpoint after the point's earlier ones and its chunks, a point's result
// after its checkpoints, the end of the job after all of it. Clients see that a point is finished
// after its result is on disk; the state they read from the job's row. The journal also writes the
// log lines about the job's beginning and end. Thread-safe.
#pragma once

#include <functional>
#include <memory>

#include "server/book/job.h"
#include "server/compute/run_journal.h"
#include "server/store/store.h"

namespace ballpiston::server {

class JobJournal : public RunJournal {
 public:
  // The store's thread calls it with the job's row.
  using OnEnded = std::function<void(const JobRecord& ended)>;

  // `resumed`: an earlier process may have stored checkpoints. Points of a job that continues
  // another one begin where its points ended (acceptance.h). `on_ended` is called when the end of
  // the job is on disk, unless the job had ended before. The store must outlive this.
  JobJournal(std::shared_ptr<Job> job, Store& store, bool resumed, OnEnded on_ended);

  void Began() override;
  absl::StatusOr<StoredPoint> ReadPoint(size_t point) override;
  uint64_t Merged(const MergedSamples& merged) override;
  void Checkpoint(size_t point, Model model, const FoldState& state) override;
  void ChunkIsEarly(size_t point, Model model, const ChunkResult& chunk) override;
  void Worked(double seconds) override;
  void PointFinished(size_t point, const PointExperiment& experiment,
                     const PointFold& fold) override;
  void Ended(const absl::Status& outcome) override;
  double AwaitRoom() override;

 private:
  const std::shared_ptr<Job> job_;
  Store& store_;
  const bool resumed_;
  const OnEnded on_ended_;
};

}  // namespace ballpiston::server
