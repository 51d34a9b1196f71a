#include "server/compute/run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model_choice/ladder.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

// Open points of a run that wait for executors elsewhere. Each keeps some 50 kB and, of a gas with
// many cells, about as much as a thread that computes it; other threads take up to 20 MB.
constexpr double kMostOpenPoints = 2000;
constexpr double kMemoryOfAnOpenPoint = 50e3;
constexpr double kMemoryOfAThread = 20e6;

// Points that one lease opens. kCheapPoints: if opening a point finishes it, in some 3 to 100 us.
// kPointsForElsewhere: if points may wait for executors elsewhere.
constexpr size_t kCheapPoints = 128;
constexpr size_t kPointsForElsewhere = 32;

// Seconds of work on a point between two checkpoints, for each local worker.
constexpr double kBetweenCheckpoints = 0.1;

}  // namespace

Run::Run(RunRequest request, SchedulerOptions options, int workers)
    : request_(std::move(request)),
      spec_(std::make_shared<const EnsembleSpec>(std::move(request_.spec))),
      options_(options),
      workers_(workers),
      taken_(std::move(request_.finished)) {
  if (request_.suspicion) {
    std::set<size_t>& points = request_.suspicion->points;
    std::erase_if(points, [this](size_t point) { return point >= taken_.size() || taken_[point]; });
    for (const size_t point : points) taken_[point] = true;
    suspected_ = points;
  }
  SkipTakenPoints();
}

void Run::SkipTakenPoints() {
  while (next_point_ < taken_.size() && taken_[next_point_]) ++next_point_;
}

// ---- leases ----

std::optional<Lease> Run::NextLease(const Capacity& capacity) {
  if (stopped_) return std::nullopt;
  if (!capacity.local) {
    std::optional<Lease> lease = IsLarge() ? NextChunks(capacity, taken_.size()) : std::nullopt;
    hungry_elsewhere_ = !lease.has_value();
    return lease;
  }
  if (IsWantedElsewhere()) return NextOpening();
  awaited_memory_ = 0;
  std::optional<Lease> lease = NextChunks(capacity, taken_.size());
  return lease || awaited_memory_ > 0 ? std::move(lease) : NextOpening();
}

std::optional<Lease> Run::NextChunks(const Capacity& capacity, size_t end) {
  for (auto next = leasable_.begin(); next != leasable_.end() && *next < end;) {
    const size_t index = *next++;
    if (IsHeldBack(index)) continue;
    OpenPoint& point = *open_.at(index);
    auto lease = point.NextChunks(capacity);
    if (lease) {
      lease->point = index;
      return Completed(*std::move(lease));
    }
    // Otherwise the point may have chunks for a local executor, although it has none for this one.
    if (capacity.local && !NoteAwaited(point, capacity)) leasable_.erase(index);
  }
  return std::nullopt;
}

// Whether the point has a lease that takes more memory than there is.
bool Run::NoteAwaited(const OpenPoint& point, const Capacity& capacity) {
  if (!point.AwaitsMemory(capacity)) return false;
  const double needed = point.memory.of_one_turn;
  awaited_memory_ = awaited_memory_ == 0 ? needed : std::min(awaited_memory_, needed);
  return true;
}

bool Run::IsHeldBack(size_t point) const {
  const std::optional<Suspicion>& suspicion = request_.suspicion;
  return suspicion && !suspicion->points.empty() && !suspicion->points.contains(point);
}

Lease Run::Completed(Lease lease) const {
  lease.run = request_.key;
  lease.generation = request_.generation;
  lease.spec = spec_;
  return lease;
}

bool Run::IsLarge() const {
  if (sampled_points_ == 0 || spec_->target.budget_seconds) return false;
  const auto unopened = static_cast<double>(taken_.size() - next_point_ + suspected_.size());
  double seconds = unopened * sampled_seconds_ / sampled_points_;
  for (const auto& [index, point] : open_) {
    if (seconds >= options_.least_seconds_elsewhere) break;
    seconds += point->ExpectedSeconds();
  }
  return seconds >= options_.least_seconds_elsewhere;
}

bool Run::IsWantedElsewhere() const {
  return hungry_elsewhere_ && HasPointsToOpen() && IsLarge() && PointsToOpenAhead() > 0;
}

// The number of points that this run may open for executors elsewhere, beside its open points.
// Requires IsLarge().
size_t Run::PointsToOpenAhead() const {
  const double one =
      std::max(sampled_memory_ / sampled_points_ - kMemoryOfAThread, kMemoryOfAnOpenPoint);
  const double most = std::min(kMostOpenPoints, options_.memory_limit / one);
  const auto open = static_cast<double>(open_.size() + opening_.size());
  return open >= most ? 0 : static_cast<size_t>(std::ceil(most - open));
}

std::optional<Lease> Run::NextOpening() {
  const size_t most = NeedsNoSamples(*spec_) ? kCheapPoints
                      : IsWantedElsewhere()  ? std::min(kPointsForElsewhere, PointsToOpenAhead())
                                             : 1;
  Lease lease;
  while (lease.opens.size() < most && !suspected_.empty()) {
    lease.opens.push_back(suspected_.extract(suspected_.begin()).value());
  }
  while (lease.opens.size() < most && next_point_ < taken_.size() && !IsHeldBack(next_point_)) {
    lease.opens.push_back(next_point_++);
    SkipTakenPoints();
  }
  if (lease.opens.empty()) return std::nullopt;
  lease.stop = stop_opening_.get_token();
  opening_.insert(lease.opens.begin(), lease.opens.end());
  return Completed(std::move(lease));
}

// ---- points ----

void Run::PointOpened(size_t point, std::unique_ptr<OpenPoint> open) {
  if (stopped_) open->RequestStop();
  sampled_points_ += 1;
  sampled_seconds_ += open->ExpectedSeconds();
  sampled_memory_ += open->memory.of_one_turn;
  opening_.erase(point);
  open_.emplace(point, std::move(open));
  leasable_.insert(point);
}

bool Run::IsUnopened(size_t point) const {
  if (stopped_ || point >= taken_.size()) return false;
  return suspected_.contains(point) || opening_.contains(point) ||
         (point >= next_point_ && !taken_[point]);
}

OpenPoint* Run::Find(size_t point) const {
  const auto open = open_.find(point);
  return open == open_.end() ? nullptr : open->second.get();
}

void Run::Close(size_t point) {
  NoteProgress(point);
  leasable_.erase(point);
  open_.erase(point);
}

void Run::Return(const Lease& lease, int attempt) {
  if (OpenPoint* open = Find(lease.point)) {
    open->Return(lease.start.chunk, lease.end, attempt, lease.crashes);
    leasable_.insert(lease.point);
  }
}

void Run::NoteProgress(size_t point) {
  has_progressed_ = true;
  opening_.erase(point);
  if (request_.suspicion) request_.suspicion->points.erase(point);
}

bool Run::IsRefuted() const {
  const std::optional<Suspicion>& suspicion = request_.suspicion;
  return suspicion && suspicion->points.empty() && has_progressed_;
}

// ---- reports ----

// A chunk of another machine does not refute the suspicion that some point kills this process.
uint64_t Run::Merge(const Lease& lease, OpenPoint& open, LeaseReport report) {
  PointFold& fold = open.fold();
  open.work += report.seconds;
  uint64_t samples = 0;
  const bool has_chunks = !report.chunks.empty();
  if (has_chunks && lease.local) NoteProgress(lease.point);
  has_progressed_ |= has_chunks;
  for (ChunkResult& chunk : report.chunks) {
    const bool is_early = fold.Needs(chunk.chunk) && chunk.chunk > fold.state().chunk;
    if (is_early) journal().ChunkIsEarly(lease.point, open.model(), chunk);
    samples += fold.Add(std::move(chunk));
  }
  samples += fold.AddPartial(report.partial);
  leasable_.insert(lease.point);
  if (samples > 0) {
    open.version = journal().Merged(
        {.point = lease.point, .samples = samples, .share_of_point = open.ShareOf(samples)});
  }
  if (!fold.finished()) EndIfBudgetIsSpent(lease, open, report.begun);
  if (fold.finished()) NoteShortfall(lease.point, open);
  // The files of an executor elsewhere may go when the lease ends, so its chunks are written now.
  const bool at_once = !lease.local || (request_.suspicion && has_chunks);
  if (!fold.finished() && samples > 0) CheckpointIfDue(lease.point, open, at_once);
  return samples;
}

// Blocks that have begun are awaited: without them short orbits would be preferred, because a block
// of long ones is more likely to be in progress at the end. A lease normally has all the rest of
// its point, but not on a server with a cluster, where such blocks are dropped. Blocks of
// trajectories are not awaited, because their time does not depend on what happens in them. But a
// point computes its whole first stage, because an error needs several groups.
void Run::EndIfBudgetIsSpent(const Lease& lease, OpenPoint& open, uint64_t begun) {
  if (!spec_->target.budget_seconds || open.work < BudgetOfAPoint(*spec_, workers_)) return;
  const ChunkPlan& plan = open.experiment()->plan();
  const bool has_the_rest =
      lease.start.chunk <= open.fold().state().chunk && lease.end == plan.chunks();
  if (begun > 0 && plan.groups() == 0 && has_the_rest) {
    open.RequestEnd();
    return;
  }
  const bool all_have_begun = open.fold().state().chunk >= plan.groups();
  if (open.fold().HasBlocks() && all_have_begun) open.fold().Finish();
}

void Run::NoteShortfall(size_t point, const OpenPoint& open) {
  const std::optional<double>& tolerance = spec_->target.tolerance;
  if (!tolerance || !open.fold().HasBlocks()) return;
  const Estimate reached = open.experiment()->FirstEstimate(open.fold().Merged());
  if (RelativeError(reached) <= *tolerance) return;
  std::optional<Shortfall>& first = request_.shortfall;
  if (first && first->point < point) return;
  first = {point, ToleranceNotReached(*spec_, point, reached)};
}

void Run::CheckpointIfDue(size_t index, OpenPoint& open, bool at_once) {
  const double between = at_once ? 0 : kBetweenCheckpoints * workers_;
  if (!open.fold().HasBlocks() || open.work < open.work_at_checkpoint + between) return;
  open.work_at_checkpoint = open.work;
  journal().Checkpoint(index, open.model(), open.fold().state());
}

void Run::WriteCheckpoints() {
  for (const auto& [index, point] : open_) {
    const bool has_news = point->work > point->work_at_checkpoint;
    if (has_news && !point->fold().finished()) CheckpointIfDue(index, *point, true);
  }
}

// ---- for watches ----

std::optional<LivePoint> Run::Unfinished(size_t index) const {
  const auto found = open_.find(index);
  if (found == open_.end() || !found->second->fold().HasBlocks()) return std::nullopt;
  const OpenPoint& point = *found->second;
  return LivePoint{index, point.version, point.experiment(), point.fold().Merged()};
}

std::vector<LivePoint> Run::NewestPoints(size_t limit) const {
  std::vector<std::pair<uint64_t, size_t>> newest;
  for (const auto& [index, point] : open_) {
    const bool finished = point->fold().finished();  // will be reported as finished
    if (point->fold().HasBlocks() && !finished) newest.emplace_back(point->version, index);
  }
  std::sort(newest.rbegin(), newest.rend());
  if (newest.size() > limit) newest.resize(limit);
  std::vector<LivePoint> points;
  for (const auto& [number, index] : newest) points.push_back(*Unfinished(index));
  return points;
}

// ---- the end ----

void Run::Stop(absl::Status reason) {
  if (std::exchange(stopped_, true)) return;
  why_stopped_ = std::move(reason);
  stop_opening_.request_stop();
  for (const auto& [index, point] : open_) point->RequestStop();
}

bool Run::over() const {
  if (turns_ > 0) return false;
  return stopped_ || (open_.empty() && opening_.empty() && !HasPointsToOpen());
}

absl::Status Run::outcome() const {
  if (stopped_) return why_stopped_;
  return request_.shortfall ? request_.shortfall->status : absl::OkStatus();
}

}  // namespace ballpiston::server
