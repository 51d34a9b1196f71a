#include "server/execution/worker_pool.h"

#include <algorithm>
#include <exception>
#include <new>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/model_choice/ladder.h"
#include "server/convert/errors.h"
#include "server/convert/fold_record.h"
#include "server/execution/processor_time.h"

namespace ballpiston::server {
namespace {

// Seconds of work on a point between two checkpoints, for each worker.
constexpr double kBetweenCheckpoints = 0.1;

// Runs `step`, and turns what it throws into a status.
template <typename Step>
absl::Status Guarded(size_t point, Step step) {
  try {
    return step();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat("point ", point, ": out of memory"));
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("point ", point, ": ", error.what()));
  } catch (...) {
    return absl::InternalError(absl::StrCat("point ", point, ": unknown exception"));
  }
}

double ShareOfPoint(const OpenPoint& open, uint64_t samples) {
  return static_cast<double>(samples) / static_cast<double>(open.experiment->plan().samples());
}

size_t PointOf(const RunTask& task) {
  return std::visit([](const auto& any) { return any.point; }, task);
}

}  // namespace

WorkerPool::WorkerPool(int workers, ExperimentFactory factory)
    : factory_(std::move(factory)), workers_(workers) {
  for (int i = 0; i < workers; ++i) threads_.emplace_back([this] { Work(); });
}

WorkerPool::~WorkerPool() { Shutdown(); }

void WorkerPool::Add(RunRequest request) {
  const int64_t key = request.key;
  auto run = std::make_shared<Run>(std::move(request));
  {
    std::lock_guard lock(mutex_);
    runs_.emplace(key, run);
    fair_share_.Add(key, run->request().principal, run->request().priority);
  }
  work_may_exist_.notify_all();
  Conclude(run);  // it may have nothing left to compute
}

void WorkerPool::Cancel(int64_t key) {
  std::shared_ptr<Run> run;
  {
    std::lock_guard lock(mutex_);
    const auto found = runs_.find(key);
    if (found == runs_.end()) return;
    run = found->second;
    run->Stop(absl::CancelledError("the job was cancelled"));
  }
  Conclude(run);
}

void WorkerPool::Shutdown() {
  std::vector<std::thread> threads;
  {
    std::lock_guard lock(mutex_);
    shutting_down_ = true;
    for (const auto& [key, run] : runs_) run->Stop(absl::CancelledError("shutting down"));
    threads.swap(threads_);
  }
  work_may_exist_.notify_all();
  for (std::thread& thread : threads) thread.join();
  std::lock_guard lock(mutex_);
  for (const auto& [key, run] : runs_) WriteCheckpoints(*run);
}

void WorkerPool::WriteCheckpoints(Run& run) {
  for (const auto& [index, point] : run.open_points()) {
    const bool has_news = point->work > point->work_at_checkpoint;
    if (!point->fold.HasBlocks() || point->fold.finished() || !has_news) continue;
    point->work_at_checkpoint = point->work;
    run.journal().Checkpoint(index, point->fold.state());
  }
}

std::vector<LivePoint> WorkerPool::ChangedSince(int64_t key, uint64_t version, size_t limit) const {
  std::vector<LivePoint> changed;
  std::lock_guard lock(mutex_);
  const auto run = runs_.find(key);
  if (run == runs_.end()) return changed;
  std::vector<std::pair<uint64_t, size_t>> newest;
  for (const auto& [index, point] : run->second->open_points()) {
    const bool finished = point->fold.finished();  // will be reported as finished
    if (point->version > version && point->fold.HasBlocks() && !finished)
      newest.emplace_back(point->version, index);
  }
  std::sort(newest.rbegin(), newest.rend());
  if (newest.size() > limit) newest.resize(limit);
  for (const auto& [number, index] : newest) {
    const OpenPoint& point = *run->second->FindOpen(index);
    changed.push_back({index, number, point.experiment, point.fold.Merged()});
  }
  return changed;
}

PoolCounts WorkerPool::Counts() const {
  return {.workers = workers_,
          .busy = busy_.load(std::memory_order_relaxed),
          .blocks = static_cast<double>(blocks_.load(std::memory_order_relaxed)),
          .samples = samples_.load(std::memory_order_relaxed),
          .processor_seconds = processor_seconds_.load(std::memory_order_relaxed)};
}

void WorkerPool::Work() {
  while (const auto assignment = AwaitAssignment()) {
    if (assignment->begins_run) assignment->run->journal().Began();
    busy_.fetch_add(1, std::memory_order_relaxed);
    Execute(*assignment);
    busy_.fetch_sub(1, std::memory_order_relaxed);
    Conclude(assignment->run);
    assignment->run->journal().AwaitRoom();
  }
}

std::optional<WorkerPool::Assignment> WorkerPool::AwaitAssignment() {
  std::unique_lock lock(mutex_);
  while (!shutting_down_) {
    if (auto assignment = ChooseLocked()) return assignment;
    work_may_exist_.wait(lock);
  }
  return std::nullopt;
}

std::optional<WorkerPool::Assignment> WorkerPool::ChooseLocked() {
  std::optional<RunTask> task;
  const auto key = fair_share_.First([&](int64_t run) {
    task = runs_.at(run)->NextTask();
    return task.has_value();
  });
  if (!key) return std::nullopt;
  fair_share_.TurnBegins(*key);
  const std::shared_ptr<Run>& run = runs_.at(*key);
  Assignment assignment{run, *std::move(task), !run->began()};
  run->set_began();
  return assignment;
}

void WorkerPool::Execute(const Assignment& assignment) {
  Run& run = *assignment.run;
  const double start = ThreadSeconds();
  std::shared_ptr<BlockSession> resting;
  absl::Status status;
  if (const auto* task = std::get_if<SessionTask>(&assignment.task)) {
    status = Advance(run, *task, resting);
  } else {
    status = OpenNewPoint(run, std::get<OpenPointTask>(assignment.task));
  }
  const double seconds = ThreadSeconds() - start;
  run.journal().Worked(seconds);
  processor_seconds_.fetch_add(seconds, std::memory_order_relaxed);
  {
    std::lock_guard lock(mutex_);
    if (!status.ok()) run.Stop(status);
    run.TaskDone(assignment.task);
    if (resting != nullptr) run.Rest(PointOf(assignment.task), std::move(resting));
    fair_share_.TurnEnds(run.request().key, seconds);
  }
  work_may_exist_.notify_all();
}

absl::Status WorkerPool::OpenNewPoint(Run& run, const OpenPointTask& task) {
  return Guarded(task.point, [&]() -> absl::Status {
    std::shared_ptr<const PointExperiment> made =
        factory_(run.request().spec, task.point, task.stop);
    if (made == nullptr) return absl::OkStatus();  // the run was stopped
    auto open = std::make_unique<OpenPoint>(std::move(made));
    if (run.request().has_checkpoints) {
      const absl::Status resumed = Resume(run, task.point, *open);
      if (!resumed.ok()) return resumed;
    }
    const bool finished = open->fold.finished();
    {
      std::lock_guard lock(mutex_);
      run.PointOpened(task.point, std::move(open));
    }
    if (finished) ClosePoint(run, task.point);
    return absl::OkStatus();
  });
}

absl::Status WorkerPool::Resume(Run& run, size_t point, OpenPoint& open) {
  absl::StatusOr<std::optional<FoldState>> state = run.journal().ReadCheckpoint(point);
  if (!state.ok()) return state.status();
  // With a budget the earlier process may have chosen a model that samples, and this one a model
  // that does not.
  if (!*state || open.fold.finished()) return absl::OkStatus();
  const absl::Status checked = CheckFoldState(*open.experiment, **state);
  if (!checked.ok()) return checked;
  open.fold.Resume(**std::move(state));
  const uint64_t samples = open.fold.PlannedSamples();
  open.version = run.journal().Merged({.point = point,
                                       .samples = samples,
                                       .share_of_point = ShareOfPoint(open, samples),
                                       .restored = true});
  return absl::OkStatus();
}

absl::Status WorkerPool::Advance(Run& run, const SessionTask& task,
                                 std::shared_ptr<BlockSession>& resting) {
  return Guarded(task.point, [&]() -> absl::Status {
    std::shared_ptr<BlockSession> session = task.session;
    if (session == nullptr) {
      session = std::make_shared<BlockSession>(static_cast<BlockExchange&>(*this), run, task.point,
                                               task.experiment, task.stop);
    }
    if (session->Advance()) resting = std::move(session);
    return absl::OkStatus();
  });
}

std::optional<Block> WorkerPool::NextBlock(Run& run, size_t point) {
  std::lock_guard lock(mutex_);
  OpenPoint* open = run.FindOpen(point);
  if (open == nullptr || open->stop.stop_requested()) return std::nullopt;
  return open->fold.NextBlock();
}

void WorkerPool::BlockDone(Run& run, size_t point, const Block& block, BlockResult result,
                           double seconds) {
  blocks_.fetch_add(1, std::memory_order_relaxed);
  samples_.fetch_add(static_cast<double>(result.samples), std::memory_order_relaxed);
  {
    std::lock_guard lock(mutex_);
    OpenPoint* open = run.FindOpen(point);
    if (open == nullptr || open->fold.finished()) return;
    open->work += seconds;
    const bool had_no_block = !open->fold.HasNextBlock();
    if (const uint64_t samples = open->fold.Add(block, std::move(result)); samples > 0) {
      open->version = run.journal().Merged(
          {.point = point, .samples = samples, .share_of_point = ShareOfPoint(*open, samples)});
    }
    if (had_no_block && open->fold.HasNextBlock()) work_may_exist_.notify_all();
    if (!CameToItsEnd(run, point, *open)) return;
  }
  ClosePoint(run, point);
}

void WorkerPool::TurnEnds(Run& run, size_t point, double seconds) {
  {
    std::lock_guard lock(mutex_);
    OpenPoint* open = run.FindOpen(point);
    if (open == nullptr || open->fold.finished()) return;
    open->work += seconds;
    if (!CameToItsEnd(run, point, *open)) return;
  }
  ClosePoint(run, point);
}

bool WorkerPool::CameToItsEnd(Run& run, size_t point, OpenPoint& open) {
  if (!open.fold.finished()) EndIfBudgetIsSpent(run, point, open);
  if (open.fold.finished()) {
    open.stop.request_stop();  // blocks beyond the target are not needed
    return true;
  }
  if (open.fold.HasBlocks() &&
      open.work >= open.work_at_checkpoint + kBetweenCheckpoints * workers_) {
    open.work_at_checkpoint = open.work;
    run.journal().Checkpoint(point, open.fold.state());
  }
  return false;
}

void WorkerPool::EndIfBudgetIsSpent(Run& run, size_t point, OpenPoint& open) {
  const EnsembleSpec& spec = run.request().spec;
  if (!spec.target.budget_seconds || !open.fold.HasBlocks()) return;
  if (open.work < BudgetOfAPoint(spec, workers_)) return;
  open.fold.Finish();
  if (!spec.target.tolerance) return;
  const Estimate reached = open.experiment->FirstEstimate(open.fold.Merged());
  if (MeetsTolerance(reached, *spec.target.tolerance)) return;
  run.NoteShortfall({point, ToleranceNotReached(spec, point, reached)});
}

void WorkerPool::ClosePoint(Run& run, size_t point) {
  const OpenPoint* open = nullptr;
  {
    std::lock_guard lock(mutex_);
    open = run.FindOpen(point);
  }
  // A finished merge changes no more, and only this thread closes the point.
  run.journal().PointFinished(point, *open->experiment, open->fold.Merged());
  std::lock_guard lock(mutex_);
  run.PointClosed(point);
}

void WorkerPool::Conclude(const std::shared_ptr<Run>& run) {
  {
    std::lock_guard lock(mutex_);
    const auto found = runs_.find(run->request().key);
    if (shutting_down_ || found == runs_.end() || !run->over()) return;
    fair_share_.Remove(found->first);
    runs_.erase(found);
  }
  run->journal().Ended(run->outcome());
}

}  // namespace ballpiston::server
