#include "server/compute/scheduler.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/model_choice/ladder.h"
#include "server/compute/crash_record.h"
#include "server/compute/guarded.h"
#include "server/convert/errors.h"
#include "server/convert/fold_record.h"

namespace ballpiston::server {
namespace {

// Seconds of work on a point between two checkpoints, for each local worker.
constexpr double kBetweenCheckpoints = 0.1;

// Leases with all the rest of a point, which may last for hours, take at most this share of the
// memory together. So a run that waits for memory seldom waits for one of them.
constexpr double kShareOfTheRest = 0.25;

// Also: a chunk has at least the samples of its merged blocks.
absl::Status CheckChunkOf(const OpenPoint& open, const ChunkResult& chunk) {
  const FoldState& state = open.fold().state();
  if (chunk.chunk == state.chunk && chunk.result.samples < state.partial.samples) {
    return absl::DataLossError("a chunk has fewer samples than its merged blocks");
  }
  return CheckChunk(*open.experiment(), chunk);
}

// Removes chunks that the experiment cannot have computed. DATA_LOSS if there are any.
absl::Status DropImpossible(const OpenPoint& open, std::vector<ChunkResult>& chunks) {
  absl::Status found;
  std::erase_if(chunks, [&](const ChunkResult& chunk) {
    const absl::Status checked = CheckChunkOf(open, chunk);
    if (!checked.ok()) found = checked;
    return !checked.ok();
  });
  return found;
}

double ShareOfPoint(const OpenPoint& open, uint64_t samples) {
  return static_cast<double>(samples) / static_cast<double>(open.experiment()->plan().samples());
}

}  // namespace

Scheduler::Scheduler(PointOpener& opener, int workers, SchedulerOptions options)
    : opener_(opener), workers_(workers), options_(options) {}

size_t Scheduler::AddExecutor(Executor& executor) {
  MutexLock lock(mutex_);
  executors_.push_back({&executor, executor.traits(), {}});
  return executors_.size() - 1;
}

void Scheduler::RemoveExecutor(size_t executor) {
  MutexLock lock(mutex_);
  executors_[executor].executor = nullptr;
}

std::vector<Executor*> Scheduler::Executors() const {
  MutexLock lock(mutex_);
  std::vector<Executor*> executors;
  for (const Member& member : executors_) {
    if (member.executor != nullptr) executors.push_back(member.executor);
  }
  return executors;
}

// ---- runs ----

void Scheduler::Add(RunRequest request) {
  const bool is_suspect = request.suspicion.has_value();
  const int32_t priority = request.priority;
  const auto run = std::make_shared<Run>(std::move(request), options_);
  {
    MutexLock lock(mutex_);
    runs_.emplace(run->key(), run);
    if (is_suspect) suspects_.push_back(run->key());
    for (Member& member : executors_) {
      member.shares.Add(run->key(), run->principal(), priority);
    }
  }
  WakeExecutors();
  Conclude(run);  // the run may have nothing left to compute
}

void Scheduler::SetPriority(int64_t run, int32_t priority) {
  MutexLock lock(mutex_);
  for (Member& member : executors_) member.shares.SetPriority(run, priority);
}

void Scheduler::Stop(int64_t key, absl::Status why) {
  RunPointer run;
  {
    MutexLock lock(mutex_);
    run = FindRun(key);
    if (run == nullptr) return;
    StopRun(*run, std::move(why));
  }
  WakeExecutors();
  Conclude(run);
}

void Scheduler::Shutdown() {
  {
    MutexLock lock(mutex_);
    if (std::exchange(shutting_down_, true)) return;
    for (const auto& [key, run] : runs_) run->Stop(absl::CancelledError("shutting down"));
  }
  for (Executor* executor : Executors()) executor->Shutdown();
  MutexLock lock(mutex_);
  for (const auto& [key, run] : runs_) WriteCheckpoints(*run);
}

Scheduler::RunPointer Scheduler::FindRun(int64_t key) const {
  const auto found = runs_.find(key);
  return found == runs_.end() ? nullptr : found->second;
}

void Scheduler::StopRun(Run& run, absl::Status why) {
  run.Stop(std::move(why));
  DropStoppedLeases(run);
  EndPilotsOf(run);
}

void Scheduler::EndPilotsOf(const Run& run) {
  std::vector<PilotPlace> left;
  for (const auto& [place, owner] : pilots_) {
    if (owner == run.key()) left.push_back(place);
  }
  for (const PilotPlace& place : left) EndPilot(run, place);
}

// Runs that wait for the pilot open their points again; the first of them may start the pilot
// again.
void Scheduler::EndPilot(const Run& owner, const PilotPlace& place) {
  const auto found = pilots_.find(place);
  if (found == pilots_.end() || found->second != owner.key()) return;  // another run has it
  pilots_.erase(found);
  for (const auto& [key, run] : runs_) run->PilotIsKnown(place);
}

// For executors elsewhere, also ends the run's turn at each of its leases.
void Scheduler::DropStoppedLeases(const Run& run) {
  for (size_t i = 0; i < executors_.size(); ++i) {
    const bool is_local = executors_[i].traits.local;
    auto held = held_.lower_bound({i, run.key(), 0});
    const auto end = held_.lower_bound({i, run.key() + 1, 0});
    while (held != end) {
      const bool drops =
          held->second.lease.stop.stop_requested() && !(is_local && held->second.turns > 0);
      if (drops && !is_local) executors_[i].shares.TurnEnds(run.key(), 0);
      held = drops ? Drop(held) : std::next(held);
    }
  }
}

void Scheduler::Conclude(const RunPointer& run) {
  bool others_go_on = false;
  {
    MutexLock lock(mutex_);
    const auto found = runs_.find(run->key());
    if (shutting_down_ || found == runs_.end() || !run->over()) return;
    for (Member& member : executors_) member.shares.Remove(run->key());
    runs_.erase(found);
    others_go_on = std::erase(suspects_, run->key()) > 0;
    if (waiting_ && waiting_->run == run->key()) {
      waiting_.reset();
      others_go_on = true;
    }
  }
  if (others_go_on) WakeExecutors();
  run->journal().Ended(run->outcome());
}

// ---- suspects ----

bool Scheduler::IsPaused(const Run& run) const {
  return !suspects_.empty() && run.key() != suspects_.front();
}

// A suspect waits for the end of the others' turns, so that their deaths are not its own.
bool Scheduler::MayTakeTurn(const Run& run, const Member& member) const {
  if (suspects_.empty()) return true;
  if (IsPaused(run) || !member.traits.local) return false;
  return std::ranges::none_of(
      runs_, [&](const auto& other) { return other.second->HasTurns() && &run != &*other.second; });
}

// Between two turns, because the disk may be slow.
void Scheduler::ClearIfRefuted(const RunPointer& run) {
  std::function<bool()> clear;
  {
    MutexLock lock(mutex_);
    if (suspects_.empty() || IsPaused(*run) || run->refuted() == nullptr) return;
    clear = run->refuted()->clear;
  }
  if (!clear()) return;
  {
    MutexLock lock(mutex_);
    std::erase(suspects_, run->key());
    run->EndSuspicion();
  }
  WakeExecutors();
}

void Scheduler::WakeExecutors() {
  for (Executor* executor : Executors()) executor->Wake();
}

// ---- leases ----

std::optional<Lease> Scheduler::Next(const Capacity& capacity) {
  std::optional<Lease> lease;
  RunPointer run;
  bool begins = false;
  {
    MutexLock lock(mutex_);
    if (shutting_down_) return std::nullopt;
    lease = Choose(capacity);
    if (!lease) return std::nullopt;
    Member& member = executors_[capacity.executor];
    member.shares.TurnBegins(lease->run);
    run = runs_.at(lease->run);
    if (member.traits.local) run->TurnBegins();
    begins = !run->began();
    run->set_began();
  }
  if (begins) run->journal().Began();
  return lease;
}

// Of the first run, in the order of turns, that has one.
std::optional<Lease> Scheduler::Choose(const Capacity& capacity) {
  const Member& member = executors_[capacity.executor];
  const bool one_waited = waiting_.has_value();
  std::optional<Lease> lease;
  member.shares.First([&](int64_t candidate) {
    mutex_.AssertHeld();
    Run& run = *runs_.at(candidate);
    if (!MayTakeTurn(run, member)) return false;
    lease = NextOf(run, CapacityFor(run, capacity));
    if (member.traits.local) NoteWaiting(run, lease.has_value());
    return lease.has_value();
  });
  const bool none_waits_now = one_waited && !waiting_;  // the runs before it have memory again
  return lease || !none_waits_now ? lease : Choose(capacity);
}

// Of a new lease.
Capacity Scheduler::CapacityFor(const Run& run, const Capacity& capacity) const {
  Capacity now = capacity;
  if (!executors_[capacity.executor].traits.local) return now;
  const bool another_waits = waiting_ && waiting_->run != run.key();
  if (another_waits || held_memory_ > 0) now.memory = FreeMemory(another_waits);
  now.memory_of_the_rest = kShareOfTheRest * options_.memory_limit - held_memory_;
  if (!suspects_.empty()) now.seconds = 0;
  return now;
}

// Bytes that a lease of a local executor can still take, if it began after a run began to wait.
double Scheduler::FreeMemory(bool is_later) const {
  const double free = options_.memory_limit - held_memory_;
  if (!is_later) return free;
  return std::min(free, options_.memory_limit - waiting_->memory - waiting_->later);
}

bool Scheduler::IsLater(const Lease& lease) const {
  return waiting_ && lease.number > waiting_->last_lease;
}

void Scheduler::AddMemory(const Lease& lease, double bytes) {
  held_memory_ += bytes;
  if (IsLater(lease)) waiting_->later += bytes;
}

// A run without a lease waits. It keeps its place until it has a lease, or needs none.
void Scheduler::NoteWaiting(const Run& run, bool has_lease) {
  const double needed = has_lease || HoldsLease(run) ? 0 : run.awaited_memory();
  if (needed > 0 && !waiting_) waiting_ = {run.key(), needed, last_number_};
  if (needed == 0 && waiting_ && waiting_->run == run.key()) waiting_.reset();
}

Scheduler::HeldLeases::iterator Scheduler::Drop(HeldLeases::iterator held) {
  const auto& [lease, turns, most_turns] = held->second;
  AddMemory(lease, -lease.memory.of_one_turn - (most_turns - 1) * lease.memory.of_a_further_turn);
  return held_.erase(held);
}

std::optional<Lease> Scheduler::NextOf(Run& run, const Capacity& capacity) {
  const ExecutorTraits& executor = executors_[capacity.executor].traits;
  const bool may_continue = executor.local && !run.stopped() && !run.IsWantedElsewhere();
  Held* held = may_continue ? HeldWithTurn(run, capacity.executor) : nullptr;
  std::optional<Lease> lease;
  if (suspects_.empty() || !HoldsLease(run)) {
    lease = held != nullptr ? run.NextLeaseBefore(held->lease, capacity, executor)
                            : run.NextLease(capacity, executor);
  }
  if (lease) {
    lease->number = ++last_number_;
    lease->executor = capacity.executor;
    if (lease->OpensPoints()) return lease;
    held = &held_.emplace(KeyOf(*lease), Held{*lease}).first->second;
  }
  if (held == nullptr) return std::nullopt;
  BeginTurn(*held);
  return held->lease;
}

void Scheduler::BeginTurn(Held& held) {
  if (++held.turns <= held.most_turns) return;
  const LeaseMemory& memory = held.lease.memory;
  AddMemory(held.lease, held.turns == 1 ? memory.of_one_turn : memory.of_a_further_turn);
  held.most_turns = held.turns;
}

// Returns the lease that goes before the others (Lease::GoesBefore), among the leases of the run
// that the executor holds, that have a turn, and for whose turn there is memory.
Scheduler::Held* Scheduler::HeldWithTurn(const Run& run, size_t executor) {
  Held* first = nullptr;
  const auto end = held_.lower_bound({executor, run.key() + 1, 0});
  for (auto next = held_.lower_bound({executor, run.key(), 0}); next != end; ++next) {
    Held& held = next->second;
    const Lease& lease = held.lease;
    const bool has_memory = held.turns < held.most_turns ||
                            lease.memory.of_a_further_turn <= FreeMemory(IsLater(lease));
    if (lease.stop.stop_requested() || !has_memory) continue;
    if (first != nullptr && !lease.GoesBefore(first->lease)) continue;
    if (executors_[executor].executor->HasTurn(lease.number)) first = &held;
  }
  return first;
}

// Of a local executor.
bool Scheduler::HoldsLease(const Run& run) const {
  for (size_t i = 0; i < executors_.size(); ++i) {
    const auto next = held_.lower_bound({i, run.key(), 0});
    const bool holds = next != held_.lower_bound({i, run.key() + 1, 0});
    if (holds && executors_[i].traits.local) return true;
  }
  return false;
}

bool Scheduler::EndTurn(const Lease& lease, double seconds) {
  processor_seconds_.fetch_add(seconds, std::memory_order_relaxed);
  RunPointer run;
  bool continues = false;
  {
    MutexLock lock(mutex_);
    run = FindRun(lease.run);
    run->journal().Worked(seconds);
    run->TurnEnds();
    executors_[lease.executor].shares.TurnEnds(lease.run, seconds);
    if (lease.OpensPoints()) {
      run->OpeningEnded();
    } else if (const auto held = held_.find(KeyOf(lease)); held != held_.end()) {
      const bool stopped = lease.stop.stop_requested();
      continues = !stopped && executors_[lease.executor].executor->HasTurn(lease.number);
      if (--held->second.turns == 0 && !continues) Drop(held);
      continues = !stopped && held_.contains(KeyOf(lease));
    }
  }
  WakeExecutors();
  ClearIfRefuted(run);
  Conclude(run);
  run->journal().AwaitRoom();
  return continues;
}

void Scheduler::Return(const Lease& lease, bool tried) {
  RunPointer run;
  {
    MutexLock lock(mutex_);
    run = FindRun(lease.run);
    if (run == nullptr || held_.erase(KeyOf(lease)) == 0) return;  // it was stopped
    executors_[lease.executor].shares.TurnEnds(lease.run, 0);
    run->Return(lease, tried ? lease.attempt + 1 : lease.attempt);
  }
  WakeExecutors();
  run->journal().AwaitRoom();
}

void Scheduler::ReturnCrashed(Lease lease) {
  ++lease.crashes;
  if (lease.crashes < kMostDeaths || !Needs(lease)) return Return(lease);
  Fail(lease, EngineCrashed(absl::StrCat("point ", lease.point, " on the cluster"), lease.crashes));
}

bool Scheduler::Needs(const Lease& lease) const {
  MutexLock lock(mutex_);
  return held_.contains(KeyOf(lease));
}

void Scheduler::AwaitRoom() {
  RunPointer any;
  {
    MutexLock lock(mutex_);
    if (!runs_.empty()) any = runs_.begin()->second;
  }
  if (any != nullptr) any->journal().AwaitRoom();
}

void Scheduler::Fail(const Lease& lease, absl::Status why) { Stop(lease.run, std::move(why)); }

// ---- opening points ----

void Scheduler::Open(const Lease& lease, size_t point) {
  if (lease.stop.stop_requested()) return;
  RunPointer run;
  {
    MutexLock lock(mutex_);
    run = FindRun(lease.run);
  }
  absl::Status opened = Guarded(point, [&] { return OpenOne(*run, point); });
  if (!opened.ok()) Fail(lease, std::move(opened));
}

absl::Status Scheduler::OpenOne(Run& run, size_t index) {
  OpenedPoint opened = opener_.Open(run.spec(), index);
  if (const auto* place = std::get_if<PilotPlace>(&opened)) return AwaitPilot(run, index, *place);
  auto open = std::make_unique<OpenPoint>(
      std::get<std::unique_ptr<const PointExperiment>>(std::move(opened)));
  open->memory = MemoryOf(run, index);
  if (run.has_checkpoints()) {
    absl::Status resumed = Resume(run, index, *open);
    if (!resumed.ok()) return resumed;
  }
  if (open->fold().finished()) {
    run.journal().PointFinished(index, *open->experiment(), open->fold());
    MutexLock lock(mutex_);
    run.NoteProgress(index);
    return absl::OkStatus();
  }
  MutexLock lock(mutex_);
  run.PointOpened(index, std::move(open));
  return absl::OkStatus();
}

// Whole bytes, so that sums are exact.
LeaseMemory Scheduler::MemoryOf(const Run& run, size_t index) {
  const double one = std::ceil(opener_.MemoryOf(run.spec(), index, 1));
  return {one, std::ceil(opener_.MemoryOf(run.spec(), index, 2)) - one};
}

absl::Status Scheduler::AwaitPilot(Run& run, size_t index, const PilotPlace& place) {
  {
    MutexLock lock(mutex_);
    if (run.stopped()) return absl::OkStatus();
    run.PointAwaits(index, place);
    if (!pilots_.emplace(place, run.key()).second) return absl::OkStatus();
  }
  absl::Cleanup give_up = [&] {
    MutexLock lock(mutex_);
    EndPilot(run, place);
  };
  // The pilot's result may have become known before this run took the pilot over.
  if (!std::holds_alternative<PilotPlace>(opener_.Open(run.spec(), index))) return absl::OkStatus();
  auto pilot = std::make_unique<OpenPoint>(opener_.OpenPilot(place));
  pilot->memory = MemoryOf(run, index);
  std::move(give_up).Cancel();
  MutexLock lock(mutex_);
  if (!run.stopped()) run.PilotOpened(place, std::move(pilot));
  return absl::OkStatus();
}

absl::Status Scheduler::Resume(Run& run, size_t index, OpenPoint& open) {
  absl::StatusOr<StoredPoint> stored = run.journal().ReadPoint(index);
  if (!stored.ok()) return stored.status();
  // With a budget the earlier process may have chosen a model that samples, and this one a model
  // that does not.
  if (open.fold().finished()) return absl::OkStatus();
  if (stored->state) {
    absl::Status checked = CheckFoldState(*open.experiment(), *stored->state);
    if (!checked.ok()) return checked;
    open.Resume(*std::move(stored->state));
  } else if (stored->earlier && stored->earlier->model == open.experiment()->answer().model &&
             CanContinueFrom(*open.experiment(), stored->earlier->state)) {
    open.Resume(std::move(stored->earlier->state));
  }
  for (ChunkResult& chunk : stored->chunks) {
    absl::Status checked = CheckChunk(*open.experiment(), chunk);
    if (!checked.ok()) return checked;
    open.fold().Add(std::move(chunk));
  }
  if (!open.fold().HasBlocks()) return absl::OkStatus();
  const uint64_t samples = open.fold().PlannedSamples();
  open.version = run.journal().Merged({.point = index,
                                       .samples = samples,
                                       .share_of_point = ShareOfPoint(open, samples),
                                       .restored = true});
  return absl::OkStatus();
}

// ---- reports ----

absl::Status Scheduler::Report(const Lease& lease, LeaseReport report) {
  RunPointer run;
  absl::Status checked;
  bool is_finished = false;
  bool is_elsewhere = false;
  {
    MutexLock lock(mutex_);
    is_elsewhere = !executors_[lease.executor].traits.local;
    run = FindRun(lease.run);
    if (run != nullptr && run->generation() != lease.generation) run = nullptr;
    if (run != nullptr && is_elsewhere && run->IsUnopened(lease.point)) {
      return absl::UnavailableError("the point is not open yet");
    }
    if (run != nullptr && is_elsewhere && IsPaused(*run)) {
      return absl::UnavailableError("the run is paused");
    }
    if (run != nullptr && is_elsewhere) Charge(*run, lease, report.seconds);
    OpenPoint* open = run ? run->Find(lease) : nullptr;
    if (open == nullptr || open->fold().finished()) return absl::OkStatus();
    if (is_elsewhere) {
      checked = DropImpossible(*open, report.chunks);
      report.partial = {};
    }
    Merge(*run, lease, *open, std::move(report));
    is_finished = open->fold().finished();
    if (is_finished) {
      open->RequestStop();
      DropStoppedLeases(*run);
      run->TurnBegins();  // so that the run does not end before its point
    }
  }
  // A local executor wakes the others when its turn ends.
  if (is_finished) {
    FinishPoint(run, lease);
  } else if (is_elsewhere) {
    WakeExecutors();
  }
  if (is_elsewhere) ClearIfRefuted(run);
  return checked;
}

void Scheduler::Charge(Run& run, const Lease& lease, double seconds) {
  processor_seconds_.fetch_add(seconds, std::memory_order_relaxed);
  run.journal().Worked(seconds);
  executors_[lease.executor].shares.Used(lease.run, seconds);
}

void Scheduler::Merge(Run& run, const Lease& lease, OpenPoint& open, LeaseReport report) {
  PointFold& fold = open.fold();
  open.work += report.seconds;
  uint64_t samples = 0;
  const bool is_local = executors_[lease.executor].traits.local;
  const bool has_chunks = !report.chunks.empty();
  if (has_chunks && !lease.pilot) {
    is_local ? run.NoteProgress(lease.point) : run.NoteProgressElsewhere();
  }
  for (ChunkResult& chunk : report.chunks) {
    const bool is_early = fold.Needs(chunk.chunk) && chunk.chunk > fold.state().chunk;
    if (is_early && !lease.pilot) run.journal().ChunkIsEarly(lease.point, chunk);
    samples += fold.Add(std::move(chunk));
  }
  samples += fold.AddPartial(report.partial);
  samples_.fetch_add(static_cast<double>(samples), std::memory_order_relaxed);
  if (lease.pilot) return;
  run.HasChunks(lease);
  if (samples > 0) {
    open.version = run.journal().Merged(
        {.point = lease.point, .samples = samples, .share_of_point = ShareOfPoint(open, samples)});
  }
  if (!fold.finished()) EndIfBudgetIsSpent(run, lease, open);
  // The files of an executor elsewhere may go when the lease ends, so its chunks are written now.
  const bool at_once = !is_local || (run.IsSuspect() && has_chunks);
  if (!fold.finished() && samples > 0) CheckpointIfDue(run, lease, open, at_once);
}

void Scheduler::EndIfBudgetIsSpent(Run& run, const Lease& lease, OpenPoint& open) {
  const EnsembleSpec& spec = run.spec();
  if (!spec.target.budget_seconds || !open.fold().HasBlocks()) return;
  if (open.work < BudgetOfAPoint(spec, workers_)) return;
  open.fold().Finish();
  if (!spec.target.tolerance) return;
  const Estimate reached = open.experiment()->FirstEstimate(open.fold().Merged());
  if (MeetsTolerance(reached, *spec.target.tolerance)) return;
  run.NoteShortfall({lease.point, ToleranceNotReached(spec, lease.point, reached)});
}

void Scheduler::CheckpointIfDue(Run& run, const Lease& lease, OpenPoint& open, bool at_once) {
  const double between = at_once ? 0 : kBetweenCheckpoints * workers_;
  if (!open.fold().HasBlocks() || open.work < open.work_at_checkpoint + between) return;
  open.work_at_checkpoint = open.work;
  run.journal().Checkpoint(lease.point, open.fold().state());
}

void Scheduler::WriteCheckpoints(Run& run) {
  for (const auto& [index, point] : run.open_points()) {
    const bool has_news = point->work > point->work_at_checkpoint;
    if (!point->fold().HasBlocks() || point->fold().finished() || !has_news) continue;
    point->work_at_checkpoint = point->work;
    run.journal().Checkpoint(index, point->fold().state());
  }
}

void Scheduler::FinishPoint(const RunPointer& run, const Lease& lease) {
  const OpenPoint* open = nullptr;
  {
    MutexLock lock(mutex_);
    open = run->Find(lease);
  }
  // A finished merge does not change, and only this thread closes the point.
  absl::Status told = Guarded(lease.point, [&] {
    if (lease.pilot) {
      opener_.KeepPilot(*lease.pilot, PilotOf(*open->experiment(), open->fold().Merged()));
    } else {
      run->journal().PointFinished(lease.point, *open->experiment(), open->fold());
    }
    return absl::OkStatus();
  });
  {
    MutexLock lock(mutex_);
    run->Close(lease);
    if (lease.pilot) EndPilot(*run, *lease.pilot);
    if (!told.ok()) StopRun(*run, std::move(told));
    run->TurnEnds();
  }
  WakeExecutors();
  Conclude(run);
}

// ---- for watches ----

std::vector<LivePoint> Scheduler::ChangedSince(int64_t key, uint64_t version, size_t limit) const {
  std::vector<LivePoint> changed;
  MutexLock lock(mutex_);
  const RunPointer run = FindRun(key);
  if (run == nullptr) return changed;
  std::vector<std::pair<uint64_t, size_t>> newest;
  for (const auto& [index, point] : run->open_points()) {
    const bool finished = point->fold().finished();  // will be reported as finished
    if (point->version > version && point->fold().HasBlocks() && !finished)
      newest.emplace_back(point->version, index);
  }
  std::sort(newest.rbegin(), newest.rend());
  if (newest.size() > limit) newest.resize(limit);
  for (const auto& [number, index] : newest) {
    const OpenPoint& point = *run->open_points().at(index);
    changed.push_back({index, number, point.experiment(), point.fold().Merged()});
  }
  return changed;
}

std::optional<LivePoint> Scheduler::Unfinished(int64_t key, size_t index) const {
  MutexLock lock(mutex_);
  const RunPointer run = FindRun(key);
  if (run == nullptr) return std::nullopt;
  const auto found = run->open_points().find(index);
  if (found == run->open_points().end()) return std::nullopt;
  const OpenPoint& point = *found->second;
  if (!point.fold().HasBlocks()) return std::nullopt;
  return LivePoint{index, point.version, point.experiment(), point.fold().Merged()};
}

WorkCounts Scheduler::Counts() const {
  return {.samples = samples_.load(std::memory_order_relaxed),
          .processor_seconds = processor_seconds_.load(std::memory_order_relaxed)};
}

}  // namespace ballpiston::server
