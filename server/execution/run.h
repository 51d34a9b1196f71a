// The state of one job during its computation: its open points and the next task for a worker.
//
// A point is opened, in grid order, when no open point has a block left to hand out. So a grid of
// 100,000 points takes only the memory of its open points. A worker computes blocks of one point in
// a session. The session keeps its orbits while the worker serves other runs, so a point has at
// most as many sessions as there are workers. Not thread-safe: the pool's lock guards it.
#ifndef BALLPISTON_SERVER_EXECUTION_RUN_H_
#define BALLPISTON_SERVER_EXECUTION_RUN_H_

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "server/execution/block_session.h"
#include "server/execution/run_journal.h"

namespace ballpiston::server {

// Makes a point's experiment. This may take seconds if a pilot has to run to choose the model. Null
// only if stop was requested. May throw.
using ExperimentFactory = std::function<std::unique_ptr<const PointExperiment>(
    const EnsembleSpec&, size_t index, const std::stop_token& stop)>;

// A point that ended without reaching its tolerance, and the status that reports it.
struct Shortfall {
  size_t point = 0;
  absl::Status status;
};

struct RunRequest {
  int64_t key = 0;        // greater for a newer job
  std::string principal;  // the job's owner, for fair shares
  int32_t priority = 0;   // among the principal's; higher first
  EnsembleSpec spec;
  std::vector<bool> finished;               // by point of the grid: nothing left to compute
  bool has_checkpoints = false;             // ask the journal for them
  std::optional<Shortfall> shortfall = {};  // of a finished point
  std::shared_ptr<RunJournal> journal;
};

struct OpenPointTask {
  size_t point = 0;
  std::stop_token stop;
};

// Blocks of a point, for a turn of some 50 ms.
struct SessionTask {
  size_t point = 0;
  std::shared_ptr<BlockSession> session;  // null: the worker makes a new session
  std::shared_ptr<const PointExperiment> experiment;
  std::stop_token stop;
};

using RunTask = std::variant<OpenPointTask, SessionTask>;

// A point whose blocks are being merged.
struct OpenPoint {
  explicit OpenPoint(std::shared_ptr<const PointExperiment> experiment_of_point)
      : experiment(std::move(experiment_of_point)), fold(*experiment) {}

  std::shared_ptr<const PointExperiment> experiment;
  PointFold fold;
  // Sessions that no worker advances now; the one that has rested longest is first.
  std::deque<std::shared_ptr<BlockSession>> resting;
  uint64_t version = 0;  // the journal's number of the point's last change
  double work = 0;       // seconds of processor time of the point's blocks
  double work_at_checkpoint = 0;
  std::stop_source stop;
};

class Run {
 public:
  explicit Run(RunRequest request);

  const RunRequest& request() const { return request_; }
  RunJournal& journal() const { return *request_.journal; }

  // The caller must call TaskDone once for each task. Points are opened one at a time: several
  // points may need the same pilot, and a second worker could only wait for it.
  std::optional<RunTask> NextTask();
  void TaskDone(const RunTask& task);
  // Keeps a session until its next turn; drops it if the point is no longer open.
  void Rest(size_t point, std::shared_ptr<BlockSession> session);

  void PointOpened(size_t point, std::unique_ptr<OpenPoint> open);
  // Null if the point is not open (any more).
  OpenPoint* FindOpen(size_t point);
  void PointClosed(size_t point);
  const std::map<size_t, std::unique_ptr<OpenPoint>>& open_points() const { return open_; }

  // Ends the run: it hands out no more tasks and requests blocks in progress to stop. The first
  // reason is kept.
  void Stop(absl::Status reason);

  // The run continues, and ends with this status unless it is stopped. The shortfall of the first
  // point is kept.
  void NoteShortfall(Shortfall shortfall);

  // No task is in progress, and none is left.
  bool over() const;
  // Requires over().
  absl::Status outcome() const { return stopped_ || !shortfall_ ? outcome_ : shortfall_->status; }

  bool began() const { return began_; }
  void set_began() { began_ = true; }

 private:
  std::optional<RunTask> NextOfOpenPoints();
  std::optional<RunTask> NextPoint();
  void SkipFinishedPoints();

  RunRequest request_;
  std::map<size_t, std::unique_ptr<OpenPoint>> open_;
  size_t next_point_ = 0;
  size_t tasks_out_ = 0;
  bool began_ = false;
  bool stopped_ = false;
  absl::Status outcome_;
  std::optional<Shortfall> shortfall_;
  bool opening_ = false;  // a point
  std::stop_source stop_opening_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_RUN_H_
