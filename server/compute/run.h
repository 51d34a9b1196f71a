// The state of one job during its computation: its open points, and its next lease.
//
// Points are opened in grid order, when no open point has a chunk left to lease, or ahead when an
// executor elsewhere has no work. So a grid of 100,000 points takes only the memory of its open
// points. Not thread-safe: the scheduler's lock guards it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/ensemble_spec.h"
#include "server/compute/open_point.h"
#include "server/compute/run_journal.h"

namespace ballpiston::server {

// A point that ended without reaching its tolerance, and the status that reports it.
struct Shortfall {
  size_t point = 0;
  absl::Status status;
};

// The run was being computed when the process died, twice. It is computed alone until this process
// has computed a chunk of each of these points, and the chunks are stored, which refutes the
// suspicion. Without points: until any chunk is stored. Only these points are computed until then.
// Long samples would take days: after two minutes alone the suspicion ends too.
struct Suspicion {
  std::set<size_t> points = {};  // that were being computed at the last death
  // Stores what was reported, which may take long, and ends the suspicion. If it is not refuted,
  // the next death is the second again. False: not now.
  std::function<bool(bool is_refuted)> end;
};

struct RunRequest {
  int64_t key = 0;         // greater for a newer job
  int64_t generation = 0;  // tells apart jobs that had this key (after a backup)
  std::string principal;   // the job's owner, for fair shares
  int32_t priority = 0;    // among the principal's; higher first
  EnsembleSpec spec;
  std::vector<bool> finished;               // by point of the grid: nothing left to compute
  bool has_checkpoints = false;             // ask the journal for them
  std::optional<Shortfall> shortfall = {};  // of a finished point
  std::optional<Suspicion> suspicion = {};
  std::shared_ptr<RunJournal> journal;
};

struct SchedulerOptions {
  // A run with less to compute, in seconds of one core at nominal speed, is computed here: to send
  // it elsewhere would take longer.
  double least_seconds_elsewhere = 60;
  // Bytes. The leases that local executors hold take no more together, unless one does alone. The
  // limit also holds, approximately, for the points of one run that wait for executors elsewhere.
  double memory_limit = std::numeric_limits<double>::infinity();
};

// An open point as it was at one moment.
struct LivePoint {
  size_t index = 0;
  uint64_t version = 0;
  std::shared_ptr<const PointExperiment> experiment;
  BlockResult merged;
};

class Run {
 public:
  // `workers`: the threads of local executors, for budgets and checkpoints.
  Run(RunRequest request, SchedulerOptions options, int workers);

  int64_t key() const { return request_.key; }
  const RunRequest& request() const { return request_; }  // without the spec
  void SetPriority(int32_t priority) { request_.priority = priority; }
  const EnsembleSpec& spec() const { return *spec_; }
  RunJournal& journal() const { return *request_.journal; }

  // A new lease for an executor; empty if there is none now.
  std::optional<Lease> NextLease(const Capacity& capacity);
  // A new lease that has chunks of a point whose index is less than `end`; empty if there is none.
  std::optional<Lease> NextChunks(const Capacity& capacity, size_t end);

  // Whether executors that are not local wait for points that nobody has opened: the next lease of
  // a local executor opens points.
  bool IsWantedElsewhere() const;

  // Bytes that a lease of a local executor needs and that were not there when NextLease gave it
  // none. 0: the run waits for no memory.
  double awaited_memory() const { return awaited_memory_; }

  // The leases of local executors, and their turns in progress: a run ends when there are none.
  void TurnBegins() { ++turns_; }
  // `seconds`: of processor time.
  void TurnEnds(double seconds = 0) {
    seconds_with_turns_ += seconds / static_cast<double>(turns_--);
  }
  bool HasTurns() const { return turns_ > 0; }

  // A lease to open points reports for each of its points that it is open, or finished (with
  // NoteProgress).
  void PointOpened(size_t point, std::unique_ptr<OpenPoint> open);

  // Whether the point is still to be opened, or is being opened.
  bool IsUnopened(size_t point) const;

  // Chunks of the lease that are still needed go out again, as this attempt.
  void Return(const Lease& lease, int attempt);

  // Null if the point is not open (any more).
  OpenPoint* Find(size_t point) const;
  void Close(size_t point);

  // Merges what was computed of the lease into `open`, its point, and tells the journal.
  // Returns the number of merged samples.
  uint64_t Merge(const Lease& lease, OpenPoint& open, LeaseReport report);
  // The point is finished. If it has not reached its tolerance, because the budget or the largest
  // number of samples is used up, the run fails at its end.
  void NoteShortfall(size_t point, const OpenPoint& open);
  // Of unfinished points with work since their last checkpoint.
  void WriteCheckpoints();

  // Copies of the unfinished points, those that changed last first, at most `limit`.
  std::vector<LivePoint> NewestPoints(size_t limit) const;
  // A copy of an unfinished point, if some of it is computed.
  std::optional<LivePoint> Unfinished(size_t index) const;

  // The point is finished, or has a chunk more that this process has computed. It is not being
  // opened any more.
  void NoteProgress(size_t point);
  // Whether the run has progressed, and no point of the suspicion is left.
  bool IsRefuted() const;
  // Whether this process has computed the run, a suspect that was alone, for two minutes.
  bool WasAloneForLong() const { return seconds_with_turns_ >= kLongAlone; }
  void EndSuspicion() { request_.suspicion.reset(); }

  // Ends the run: it gives no more leases and requests the stop of those in progress. The first
  // reason is kept.
  void Stop(absl::Status reason);
  bool stopped() const { return stopped_; }

  // No turn is in progress, and no work is left.
  bool over() const;
  // Requires over().
  absl::Status outcome() const;

  // True at the first call.
  bool Begin() { return !std::exchange(began_, true); }

 private:
  static constexpr double kLongAlone = 120;

  std::optional<Lease> NextOpening();
  bool NoteAwaited(const OpenPoint& point, const Capacity& capacity);
  // `begun`: blocks of the lease that have begun but are not merged.
  void EndIfBudgetIsSpent(const Lease& lease, OpenPoint& open, uint64_t begun);
  void CheckpointIfDue(size_t index, OpenPoint& open, bool at_once);
  // Whether only some points are computed now, and not this one.
  bool IsHeldBack(size_t point) const;
  bool HasPointsToOpen() const { return !suspected_.empty() || next_point_ < taken_.size(); }
  // The rest of the run takes long enough for executors that are not local.
  bool IsLarge() const;
  size_t PointsToOpenAhead() const;
  void SkipTakenPoints();
  Lease Completed(Lease lease) const;

  // `shortfall` is that of the first point that has one. `suspicion` has the points that are left.
  RunRequest request_;
  const std::shared_ptr<const EnsembleSpec> spec_;
  const SchedulerOptions options_;
  const int workers_;

  std::map<size_t, std::unique_ptr<OpenPoint>> open_;
  std::set<size_t> leasable_;   // open points that may have chunks to lease
  std::set<size_t> suspected_;  // points of a suspicion that are still to be opened
  std::vector<bool> taken_;     // by point: finished, or not to be opened in grid order
  size_t next_point_ = 0;       // in grid order
  std::set<size_t> opening_;    // points that are being opened
  size_t turns_ = 0;
  double seconds_with_turns_ = 0;  // processor time of a turn, divided by the turns beside it
  double awaited_memory_ = 0;
  bool hungry_elsewhere_ = false;  // an executor that is not local found nothing
  double sampled_points_ = 0;      // opened ones
  double sampled_seconds_ = 0;     // expected, of these
  double sampled_memory_ = 0;      // bytes of a turn at each of these
  bool began_ = false;
  bool stopped_ = false;
  absl::Status why_stopped_;
  bool has_progressed_ = false;
  std::stop_source stop_opening_;
};

}  // namespace ballpiston::server
