#include "server/execution/worker_pool.h"

#include <algorithm>
#include <exception>
#include <new>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/method_comparison/processor_time.h"
#include "core/model_choice/ladder.h"
#include "server/convert/block_record.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

// Blocks handed out beyond the merged prefix of a point, for each worker: enough that nobody waits
// for the slowest block, few enough that little is thrown away when a tolerance is reached.
constexpr uint64_t kWindowPerWorker = 4;

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

double ShareOfPoint(const PointExperiment& experiment, const BlockResult& result) {
  return static_cast<double>(result.samples) / static_cast<double>(experiment.plan().samples);
}

}  // namespace

WorkerPool::WorkerPool(int workers, ExperimentFactory factory)
    : factory_(std::move(factory)),
      workers_(workers),
      window_(kWindowPerWorker * static_cast<uint64_t>(workers)) {
  for (int i = 0; i < workers; ++i) threads_.emplace_back([this] { Work(); });
}

WorkerPool::~WorkerPool() { Shutdown(); }

void WorkerPool::Add(RunRequest request) {
  const int64_t key = request.key;
  auto run = std::make_shared<Run>(std::move(request), window_);
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
}

std::vector<LivePoint> WorkerPool::ChangedSince(int64_t key, uint64_t version, size_t limit) const {
  std::vector<LivePoint> changed;
  std::lock_guard lock(mutex_);
  const auto run = runs_.find(key);
  if (run == runs_.end()) return changed;
  std::vector<std::pair<uint64_t, size_t>> newest;
  for (const auto& [index, point] : run->second->open_points()) {
    const bool finished = point->merge.finished();  // about to be told as such
    if (point->version > version && !finished) newest.emplace_back(point->version, index);
  }
  std::sort(newest.rbegin(), newest.rend());
  if (newest.size() > limit) newest.resize(limit);
  for (const auto& [number, index] : newest) {
    const OpenPoint& point = *run->second->FindOpen(index);
    changed.push_back({index, number, point.experiment, point.merge.merged()});
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
  fair_share_.BlockBegins(*key);
  const std::shared_ptr<Run>& run = runs_.at(*key);
  Assignment assignment{run, *std::move(task), !run->began()};
  run->set_began();
  return assignment;
}

void WorkerPool::Execute(const Assignment& assignment) {
  Run& run = *assignment.run;
  const double start = ThreadSeconds();
  const auto* block = std::get_if<BlockTask>(&assignment.task);
  const absl::Status status = block != nullptr
                                  ? ComputeBlock(run, *block)
                                  : OpenNewPoint(run, std::get<OpenPointTask>(assignment.task));
  const double seconds = ThreadSeconds() - start;
  run.journal().Worked(seconds);
  processor_seconds_.fetch_add(seconds, std::memory_order_relaxed);
  {
    std::lock_guard lock(mutex_);
    if (!status.ok()) run.Stop(status);
    run.TaskDone(assignment.task);
    fair_share_.BlockEnds(run.request().key, seconds);
  }
  work_may_exist_.notify_all();
}

absl::Status WorkerPool::OpenNewPoint(Run& run, const OpenPointTask& task) {
  return Guarded(task.point, [&]() -> absl::Status {
    std::shared_ptr<const PointExperiment> made =
        factory_(run.request().spec, task.point, task.stop);
    if (made == nullptr) return absl::OkStatus();  // the run was stopped
    auto open = std::make_unique<OpenPoint>(std::move(made));
    if (run.request().has_stored_blocks) {
      const absl::Status restored = RestoreBlocks(run, task.point, *open);
      if (!restored.ok()) return restored;
    }
    const bool finished = open->merge.finished();
    {
      std::lock_guard lock(mutex_);
      run.PointOpened(task.point, std::move(open));
    }
    if (finished) ClosePoint(run, task.point);
    return absl::OkStatus();
  });
}

absl::Status WorkerPool::RestoreBlocks(Run& run, size_t point, OpenPoint& open) {
  const auto on_merged = [&](uint64_t block, BlockResult& result) {
    const double share = ShareOfPoint(*open.experiment, result);
    open.version = run.journal().BlockMerged({point, block, share, true, result});
  };
  absl::Status checked;
  const absl::Status read =
      run.journal().ReadStoredBlocks(point, [&](uint64_t block, BlockResult result) {
        // Those beyond the target may be of another model, which a budget chose on a slower day.
        if (!checked.ok() || open.merge.finished()) return;
        checked = CheckBlock(*open.experiment, block, result);
        if (checked.ok()) open.merge.Add(block, std::move(result), on_merged);
      });
  return read.ok() ? checked : read;
}

absl::Status WorkerPool::ComputeBlock(Run& run, const BlockTask& task) {
  return Guarded(task.point, [&]() -> absl::Status {
    const double start = ThreadSeconds();
    std::optional<BlockResult> result = task.experiment->RunBlock(task.block, task.stop);
    if (!result) return absl::OkStatus();
    blocks_.fetch_add(1, std::memory_order_relaxed);
    samples_.fetch_add(static_cast<double>(result->samples), std::memory_order_relaxed);
    MergeBlock(run, task, *std::move(result), ThreadSeconds() - start);
    return absl::OkStatus();
  });
}

void WorkerPool::MergeBlock(Run& run, const BlockTask& task, BlockResult result, double seconds) {
  {
    std::lock_guard lock(mutex_);
    OpenPoint* open = run.FindOpen(task.point);
    if (open == nullptr || open->merge.finished()) return;
    open->work += seconds;
    open->merge.Add(task.block, std::move(result), [&](uint64_t block, BlockResult& merged) {
      const double share = ShareOfPoint(*task.experiment, merged);
      open->version = run.journal().BlockMerged({task.point, block, share, false, merged});
    });
    if (!open->merge.finished()) EndIfBudgetIsSpent(run, task.point, *open);
    if (!open->merge.finished()) return;
    open->stop.request_stop();  // blocks beyond the target are in vain
  }
  ClosePoint(run, task.point);
}

void WorkerPool::EndIfBudgetIsSpent(Run& run, size_t point, OpenPoint& open) {
  const EnsembleSpec& spec = run.request().spec;
  if (!spec.target.budget_seconds || open.merge.blocks_merged() == 0) return;
  if (open.work < BudgetOfAPoint(spec, workers_)) return;
  open.merge.Finish();
  if (!spec.target.tolerance) return;
  const Estimate reached = open.experiment->FirstEstimate(open.merge.merged());
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
  run.journal().PointFinished(point, *open->experiment, open->merge.merged());
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
