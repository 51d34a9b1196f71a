// Stores the progress that a job's run reports, and updates the job.
//
// Order in the store: a checkpoint after the point's earlier ones and its chunks, a point's result
// after its checkpoints, the end of the job after all of it. Clients see that the job has begun,
// that a point is finished and that the job has ended in this order, and only after the change is
// on disk. So a restart never takes back a state that a client has seen. Thread-safe.
#ifndef BALLPISTON_SERVER_JOBS_JOB_JOURNAL_H_
#define BALLPISTON_SERVER_JOBS_JOB_JOURNAL_H_

#include <functional>
#include <memory>

#include "server/jobs/job.h"
#include "server/jobs/usage.h"
#include "server/scheduling/run_journal.h"
#include "server/store/store.h"

namespace ballpiston::server {

class JobJournal : public RunJournal {
 public:
  // `resumed`: an earlier process may have stored checkpoints. The store's thread calls `on_ended`
  // when the end of the job is on disk. Store and usage must outlive this.
  JobJournal(std::shared_ptr<Job> job, Store& store, Usage& usage, bool resumed,
             std::function<void(const Job&)> on_ended);

  void Began() override;
  absl::StatusOr<StoredPoint> ReadPoint(size_t point) override;
  uint64_t Merged(const MergedSamples& merged) override;
  void Checkpoint(size_t point, const FoldState& state) override;
  void ChunkIsEarly(size_t point, const ChunkResult& chunk) override;
  void Worked(double seconds) override;
  void PointFinished(size_t point, const PointExperiment& experiment, const BlockResult& merged,
                     const std::vector<uint64_t>& chunk_digests) override;
  void Ended(const absl::Status& outcome) override;
  void AwaitRoom() override;

 private:
  const std::shared_ptr<Job> job_;
  Store& store_;
  Usage& usage_;
  const bool resumed_;
  const std::function<void(const Job&)> on_ended_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_JOURNAL_H_
