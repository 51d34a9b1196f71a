#include "server/compute/scheduler.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/compute/crash_record.h"
#include "server/compute/guarded.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

HeldLeases::Owner OwnerOf(const Run& run) {
  return {run.request().principal, run.request().priority};
}

}  // namespace

Scheduler::Scheduler(PointOpener& opener, int workers, SchedulerOptions options)
    : opener_(opener), workers_(workers), options_(options), held_(options.memory_limit) {}

// ---- runs ----

void Scheduler::Add(RunRequest request) {
  const auto run = std::make_shared<Run>(std::move(request), options_, workers_);
  const RunRequest& asked = run->request();
  {
    MutexLock lock(mutex_);
    runs_.emplace(run->key(), run);
    if (asked.suspicion) suspects_.push_back(run->key());
    for (FairShare& shares : shares_) shares.Add(run->key(), asked.principal, asked.priority);
  }
  Wake();
  Conclude(run);  // the run may have nothing left to compute
}

void Scheduler::SetPriority(int64_t run, int32_t priority) {
  MutexLock lock(mutex_);
  if (const RunPointer found = FindRun(run)) found->SetPriority(priority);
  for (FairShare& shares : shares_) shares.SetPriority(run, priority);
}

void Scheduler::Stop(int64_t key, absl::Status why) {
  RunPointer run;
  std::vector<Lease> dropped;
  {
    MutexLock lock(mutex_);
    run = FindRun(key);
    if (run == nullptr) return;
    dropped = StopRun(*run, std::move(why));
  }
  Wake();
  Conclude(run);
}

void Scheduler::Shutdown() {
  std::vector<Lease> dropped;  // is destroyed without the lock
  MutexLock lock(mutex_);
  if (std::exchange(shutting_down_, true)) return;
  for (const auto& [key, run] : runs_) run->Stop(absl::CancelledError("shutting down"));
  Wake();
  while (HasTurns()) woken_.Wait(mutex_);
  for (const auto& [key, run] : runs_) {
    // The work of the leases may refer to objects that are destroyed before the scheduler.
    std::ranges::move(DropStoppedLeases(*run), std::back_inserter(dropped));
    run->WriteCheckpoints();
  }
}

bool Scheduler::HasTurns() const {
  return std::ranges::any_of(runs_, [](const auto& run) { return run.second->HasTurns(); });
}

Scheduler::RunPointer Scheduler::FindRun(int64_t key) const {
  const auto found = runs_.find(key);
  return found == runs_.end() ? nullptr : found->second;
}

std::vector<Lease> Scheduler::StopRun(Run& run, absl::Status why) {
  run.Stop(std::move(why));
  return DropStoppedLeases(run);
}

// Elsewhere, a turn at a lease lasts until the lease ends.
std::vector<Lease> Scheduler::DropStoppedLeases(const Run& run) {
  std::vector<Lease> dropped = held_.RemoveStopped(run.key());
  for (const Lease& lease : dropped) {
    if (!lease.local) SharesOf(lease).TurnEnds(run.key(), 0);
  }
  return dropped;
}

void Scheduler::Conclude(const RunPointer& run) {
  {
    MutexLock lock(mutex_);
    const auto found = runs_.find(run->key());
    if (shutting_down_ || found == runs_.end() || !run->over()) return;
    for (FairShare& shares : shares_) shares.Remove(run->key());
    runs_.erase(found);
    const bool was_suspect = std::erase(suspects_, run->key()) > 0;
    if (held_.EndWaiting(run->key()) || was_suspect) Wake();  // the others go on
  }
  run->journal().Ended(run->outcome());
}

// ---- suspects ----

bool Scheduler::IsPaused(const Run& run) const {
  return !suspects_.empty() && run.key() != suspects_.front();
}

// A suspect waits for the end of the others' turns, so that their deaths are not its own.
bool Scheduler::MayTakeTurn(const Run& run, bool is_local) const {
  if (suspects_.empty()) return true;
  if (IsPaused(run) || !is_local) return false;
  return std::ranges::none_of(
      runs_, [&](const auto& other) { return other.second->HasTurns() && &run != &*other.second; });
}

// Between two turns, because the disk may be slow.
void Scheduler::EndSuspicionIfDue(const RunPointer& run) {
  std::function<bool(bool)> end;
  bool is_refuted = false;
  {
    MutexLock lock(mutex_);
    if (suspects_.empty() || IsPaused(*run)) return;
    is_refuted = run->IsRefuted();
    if (!is_refuted && !run->WasAloneForLong()) return;
    end = run->request().suspicion->end;
  }
  if (!end(is_refuted)) return;
  {
    MutexLock lock(mutex_);
    std::erase(suspects_, run->key());
    run->EndSuspicion();
  }
  Wake();
}

// ---- leases ----

std::optional<Lease> Scheduler::Next(const Capacity& capacity) {
  std::optional<Lease> lease;
  RunPointer run;
  bool begins = false;
  {
    MutexLock lock(mutex_);
    while (!shutting_down_ && !(lease = Choose(capacity)) && capacity.waits) woken_.Wait(mutex_);
    if (!lease) return std::nullopt;
    SharesOf(*lease).TurnBegins(lease->run);
    run = runs_.at(lease->run);
    if (lease->local) run->TurnBegins();
    begins = run->Begin();
  }
  if (begins) run->journal().Began();
  return lease;
}

// Of the first run, in the order of turns, that has one.
std::optional<Lease> Scheduler::Choose(const Capacity& capacity) {
  const bool one_waited = held_.OneWaits();
  std::optional<Lease> lease;
  shares_[capacity.local].First([&](int64_t candidate) {
    mutex_.AssertHeld();
    Run& run = *runs_.at(candidate);
    if (!MayTakeTurn(run, capacity.local)) return false;
    lease = NextOf(run, capacity.local ? WithBounds(capacity, run) : capacity);
    if (capacity.local) held_.NoteAwaited(run.key(), lease ? 0 : run.awaited_memory());
    return lease.has_value();
  });
  const bool none_waits_now = one_waited && !held_.OneWaits();  // the others have memory again
  return lease || !none_waits_now ? lease : Choose(capacity);
}

Capacity Scheduler::WithBounds(const Capacity& capacity, const Run& run) const {
  Capacity bounded = held_.WithMemory(capacity, run.key(), OwnerOf(run));
  if (!suspects_.empty()) bounded.seconds = 0;
  return bounded;
}

std::optional<Lease> Scheduler::NextOf(Run& run, const Capacity& capacity) {
  const bool may_continue = capacity.local && !run.stopped() && !run.IsWantedElsewhere();
  HeldLeases::Held* held = may_continue ? held_.FirstWithTurn(run.key()) : nullptr;
  std::optional<Lease> lease;
  if (suspects_.empty() || !held_.HasLocal(run.key())) {
    lease = held == nullptr ? run.NextLease(capacity) : run.NextChunks(capacity, held->lease.point);
  }
  if (lease) {
    if (lease->OpensPoints()) return lease;
    held = &held_.Add(*std::move(lease), OwnerOf(run));
    if (capacity.share) held->lease.work = capacity.share(held->lease);
    Wake();  // other threads can take turns at it
  }
  if (held == nullptr) return std::nullopt;
  return held_.BeginTurn(*held);
}

void Scheduler::EndTurn(const Lease& lease, double seconds) {
  processor_seconds_.fetch_add(seconds, std::memory_order_relaxed);
  RunPointer run;
  {
    MutexLock lock(mutex_);
    run = FindRun(lease.run);
    run->journal().Worked(seconds);
    run->TurnEnds(seconds);
    SharesOf(lease).TurnEnds(lease.run, seconds);
    if (!lease.OpensPoints()) held_.EndTurn(lease);
  }
  Wake();
  EndSuspicionIfDue(run);
  Conclude(run);
  const bool has_results = lease.OpensPoints() || lease.stop.stop_requested();
  if (!has_results) return;
  const double waited = run->journal().AwaitRoom();
  MutexLock lock(mutex_);
  SharesOf(lease).Used(lease.run, waited);
}

void Scheduler::Return(const Lease& lease, bool tried) {
  RunPointer run;
  {
    MutexLock lock(mutex_);
    run = FindRun(lease.run);
    if (run == nullptr || !held_.Remove(lease)) return;  // it was stopped
    SharesOf(lease).TurnEnds(lease.run, 0);
    run->Return(lease, tried ? lease.attempt + 1 : lease.attempt);
  }
  Wake();
  run->journal().AwaitRoom();
}

void Scheduler::ReturnCrashed(Lease lease) {
  ++lease.crashes;
  if (lease.crashes < kMostDeaths || !Needs(lease)) return Return(lease);
  Stop(lease.run, EngineCrashed(absl::StrCat("point ", lease.point, " on the cluster"),
                                absl::StrCat(lease.crashes)));
}

bool Scheduler::Needs(const Lease& lease) const {
  MutexLock lock(mutex_);
  return shutting_down_ || held_.Has(lease);
}

// ---- opening points ----

void Scheduler::Open(const Lease& lease, size_t point) {
  RunPointer run;
  {
    MutexLock lock(mutex_);
    run = FindRun(lease.run);
  }
  absl::Status opened;
  do {
    if (lease.stop.stop_requested()) return;
    opened = Guarded(point, [&] { return OpenOne(*run, point); });
  } while (absl::IsUnavailable(opened));  // as RunJournal::ReadPoint says
  if (!opened.ok()) Stop(lease.run, std::move(opened));
}

absl::Status Scheduler::OpenOne(Run& run, size_t index) {
  auto open = std::make_unique<OpenPoint>(opener_.Open(run.spec(), index));
  open->memory = MemoryOf(run, index);
  if (run.request().has_checkpoints) {
    absl::Status resumed = Resume(run, index, *open);
    if (!resumed.ok()) return resumed;
  }
  if (open->fold().finished()) {
    run.journal().PointFinished(index, *open->experiment(), open->fold());
    MutexLock lock(mutex_);
    run.NoteProgress(index);
    run.NoteShortfall(index, *open);
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

absl::Status Scheduler::Resume(Run& run, size_t index, OpenPoint& open) {
  absl::StatusOr<StoredPoint> stored = run.journal().ReadPoint(index);
  absl::Status resumed = stored.ok() ? open.Resume(*std::move(stored)) : stored.status();
  if (!resumed.ok() || !open.fold().HasBlocks()) return resumed;
  const uint64_t samples = open.fold().PlannedSamples();
  open.version = run.journal().Merged({.point = index,
                                       .samples = samples,
                                       .share_of_point = open.ShareOf(samples),
                                       .restored = true});
  return resumed;
}

// ---- reports ----

absl::Status Scheduler::Report(const Lease& lease, LeaseReport report) {
  RunPointer run;
  std::vector<Lease> dropped;
  absl::Status checked;
  bool is_finished = false;
  {
    MutexLock lock(mutex_);
    run = FindRun(lease.run);
    if (run != nullptr && run->request().generation != lease.generation) run = nullptr;
    if (run != nullptr && !lease.local) {
      const bool is_now = !shutting_down_ && !run->IsUnopened(lease.point) && !IsPaused(*run);
      if (!is_now) return absl::UnavailableError("the point is not computed now");
      Charge(*run, lease, report.seconds);
    }
    OpenPoint* open = run ? run->Find(lease.point) : nullptr;
    if (open == nullptr || open->fold().finished()) return absl::OkStatus();
    if (!lease.local) {
      checked = open->DropImpossible(report.chunks);
      report.partial = {};
    }
    const auto merge = [&] {
      const uint64_t samples = run->Merge(lease, *open, std::move(report));
      samples_.fetch_add(static_cast<double>(samples), std::memory_order_relaxed);
      return absl::OkStatus();
    };
    // A local executor stops the run itself.
    absl::Status merged = lease.local ? merge() : Guarded(lease.point, merge);
    is_finished = merged.ok() && open->fold().finished();
    if (is_finished) {
      open->RequestStop();
      run->TurnBegins();  // so that the run does not end before its point
    }
    if (!merged.ok()) run->Stop(std::move(merged));
    if (is_finished || run->stopped()) dropped = DropStoppedLeases(*run);
  }
  if (is_finished) FinishPoint(run, lease);
  if (lease.local) return checked;  // the executor wakes the others when its turn ends
  if (!is_finished) Wake();
  Conclude(run);
  EndSuspicionIfDue(run);
  run->journal().AwaitRoom();
  return checked;
}

void Scheduler::Charge(Run& run, const Lease& lease, double seconds) {
  processor_seconds_.fetch_add(seconds, std::memory_order_relaxed);
  run.journal().Worked(seconds);
  SharesOf(lease).Used(lease.run, seconds);
}

void Scheduler::FinishPoint(const RunPointer& run, const Lease& lease) {
  const OpenPoint* open = nullptr;
  std::vector<Lease> dropped;
  {
    MutexLock lock(mutex_);
    open = run->Find(lease.point);
  }
  // A finished merge does not change, and only this thread closes the point.
  absl::Status told = Guarded(lease.point, [&] {
    run->journal().PointFinished(lease.point, *open->experiment(), open->fold());
    return absl::OkStatus();
  });
  {
    MutexLock lock(mutex_);
    run->Close(lease.point);
    if (!told.ok()) dropped = StopRun(*run, std::move(told));
    run->TurnEnds();
  }
  Wake();
  Conclude(run);
}

// ---- for watches ----

std::vector<LivePoint> Scheduler::NewestPoints(int64_t key, size_t limit) const {
  MutexLock lock(mutex_);
  const RunPointer run = FindRun(key);
  return run == nullptr ? std::vector<LivePoint>() : run->NewestPoints(limit);
}

std::optional<LivePoint> Scheduler::Unfinished(int64_t key, size_t index) const {
  MutexLock lock(mutex_);
  const RunPointer run = FindRun(key);
  return run == nullptr ? std::nullopt : run->Unfinished(index);
}

}  // namespace ballpiston::server
