// One job while it is computed: its open points and which block comes next.
//
// Points are opened in grid order, when no block of an open point is left to hand out, so that a
// grid of 100,000 points costs the memory of those in flight. Blocks are handed out at most
// `window` beyond the merged prefix of their point, which bounds both the results that wait and the
// work thrown away once a tolerance is reached. Not thread-safe: the pool's lock guards it.
#ifndef BALLPISTON_SERVER_EXECUTION_RUN_H_
#define BALLPISTON_SERVER_EXECUTION_RUN_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "core/experiment/ensemble_spec.h"
#include "core/experiment/point_experiment.h"
#include "server/execution/ordered_merge.h"
#include "server/execution/run_journal.h"

namespace ballpiston::server {

// Makes a point's experiment; may take seconds, where a model has to be chosen by a pilot run. Null
// only if it was told to stop. May throw.
using ExperimentFactory = std::function<std::unique_ptr<const PointExperiment>(
    const EnsembleSpec&, size_t index, const std::stop_token& stop)>;

// A point that ended short of its tolerance, and what to say of it.
struct Shortfall {
  size_t point = 0;
  absl::Status status;
};

struct RunRequest {
  int64_t key = 0;        // greater for a newer job
  std::string principal;  // whose it is, for a fair share
  int32_t priority = 0;   // among the principal's; higher first
  EnsembleSpec spec;
  std::vector<bool> finished;               // by point of the grid: nothing left to compute
  bool has_stored_blocks = false;           // ask the journal for them
  std::optional<Shortfall> shortfall = {};  // of a finished point
  std::shared_ptr<RunJournal> journal;
};

struct OpenPointTask {
  size_t point = 0;
  std::stop_token stop;
};

struct BlockTask {
  size_t point = 0;
  uint64_t block = 0;
  std::shared_ptr<const PointExperiment> experiment;
  std::stop_token stop;
};

using RunTask = std::variant<OpenPointTask, BlockTask>;

// A point whose blocks are being merged.
struct OpenPoint {
  OpenPoint(std::shared_ptr<const PointExperiment> experiment_of_point);

  // The next block to hand out, if one may be.
  std::optional<uint64_t> NextBlock(uint64_t window);

  std::shared_ptr<const PointExperiment> experiment;
  OrderedMerge merge;
  uint64_t next_block = 0;
  uint64_t version = 0;  // the journal's number of its last change
  double work = 0;       // seconds of processor time that its blocks took
  std::stop_source stop;
};

class Run {
 public:
  Run(RunRequest request, uint64_t window);

  const RunRequest& request() const { return request_; }
  RunJournal& journal() const { return *request_.journal; }

  // Every task handed out has to be followed by one TaskDone. Points are opened one at a time: they
  // may wait for the same pilot run, which no second worker can help with.
  std::optional<RunTask> NextTask();
  void TaskDone(const RunTask& task);

  void PointOpened(size_t point, std::unique_ptr<OpenPoint> open);
  // Null if the point is not open (any more).
  OpenPoint* FindOpen(size_t point);
  void PointClosed(size_t point);
  const std::map<size_t, std::unique_ptr<OpenPoint>>& open_points() const { return open_; }

  // No more tasks; blocks in flight are asked to stop. The first reason given stays.
  void Stop(absl::Status reason);

  // The run goes on, and ends with this unless it is stopped. That of the first point stays.
  void NoteShortfall(Shortfall shortfall);

  // No task is out, and none is left.
  bool over() const;
  // Of a run that is over.
  absl::Status outcome() const { return stopped_ || !shortfall_ ? outcome_ : shortfall_->status; }

  bool began() const { return began_; }
  void set_began() { began_ = true; }

 private:
  std::optional<RunTask> NextOfOpenPoints();
  std::optional<RunTask> NextPoint();
  void SkipFinishedPoints();

  RunRequest request_;
  uint64_t window_;
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
