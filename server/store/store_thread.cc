// The store's thread: it chooses the next writes, commits them in groups, and tells the outcomes.
#include <algorithm>
#include <iterator>
#include <new>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"
#include "server/store/schema.h"
#include "server/store/store.h"
#include "server/store/sweeper.h"

namespace ballpiston::server {
namespace {

// Limits the time of a transaction, and the part of the log that may not fit into the file. While
// the disk fails, groups are small, because a small group may fit where a large one does not.
constexpr size_t kMostGroupBytes = 2 << 20;
constexpr size_t kMostBytesOnFailingDisk = 128 << 10;

}  // namespace

// ---- choice of the next writes ----

void Store::WriteUntilClosed() {
  while (AwaitWork()) WriteGroup(TakeGroup());
}

// On a full disk, records wait while space is being freed, because they would use it at once.
bool Store::AllAreDue(Clock::time_point now) const {
  return closing_ || (due_ <= now && !(failing_ && sweep_advances_));
}

bool Store::SweepIsDue(Clock::time_point now) const { return !closing_ && next_sweep_ <= now; }

bool Store::GroupIsDue(Clock::time_point now) const {
  return AllAreDue(now) || requests_ > 0 || SweepIsDue(now);
}

bool Store::AwaitWork() {
  busy_since_ = 0;
  MutexLock lock(mutex_);
  while (!GroupIsDue(SteadyNow())) {
    const Clock::time_point due = std::min(due_, next_sweep_);
    if (due == kNever) {
      posted_.Wait(mutex_);
    } else {
      posted_.WaitUntil(mutex_, due);
    }
  }
  return !closing_ || !waiting_.empty();
}

// Drops each checkpoint whose point has a later waiting write, with no request between them:
// the later write may not fit into the request's group, and a flush promises all earlier records. A
// cluster reports many chunks of a point at a time, each with a checkpoint; if all of them were
// written, the chunks of first-hit that arrive in order would be accepted at a third of the rate
// (scheduler_benchmark). And while the disk fails, waiting checkpoints would soon take all the room
// of AwaitRoom, and the threads would stop computing.
void Store::DropSuperseded() {
  const auto is_checkpoint = [](const Write& write) { return write.kind == Kind::kCheckpoint; };
  if (std::ranges::none_of(waiting_, is_checkpoint)) return;  // closed forms have none
  std::set<std::pair<int64_t, int64_t>> later;                // points of the writes after `write`
  for (auto write = waiting_.end(); write != waiting_.begin();) {
    --write;
    if (write->IsRequest()) later.clear();
    const bool is_last = later.emplace(write->job, write->point).second;
    if (is_last || !is_checkpoint(*write)) continue;
    bytes_ -= write->bytes;
    write = waiting_.erase(write);
  }
}

Store::Writes Store::TakeGroup() {
  MutexLock lock(mutex_);
  const Clock::time_point now = SteadyNow();
  const bool all = AllAreDue(now);
  const size_t most = failing_ ? kMostBytesOnFailingDisk : kMostGroupBytes;
  DropSuperseded();
  Writes group;
  size_t bytes = 0;
  for (auto next = waiting_.begin(); next != waiting_.end();) {
    const auto write = next++;
    if (!all && !write->IsRequest()) {
      write->has_waited = failing_;
      continue;
    }
    bytes += write->bytes;
    if (!group.empty() && bytes > most) break;
    requests_ -= write->IsRequest() ? 1 : 0;
    group.splice(group.end(), waiting_, write);
  }
  if (waiting_.empty()) due_ = kNever;
  if (SweepIsDue(now)) group.push_back(SweepStepWrite());
  in_group_ = group.size();
  return group;
}

Store::Write Store::SweepStepWrite() {
  const auto advances = std::make_shared<bool>(false);
  return {.kind = Kind::kDeletion,
          .change = [advances](Database& database) { *advances = SweepStep(database); },
          .done = [this, advances](const absl::Status& done) { NoteSweep(done, *advances); }};
}

// ---- writing them ----

void Store::WriteGroup(Writes group) {
  const absl::Status status = CommitGroup(group.begin(), group.end());
  NoteHealth(status);  // before the callers know
  if (!status.ok()) SettleFailed(group, status);
  Settle(group);
}

void Store::SettleFailed(Writes& group, const absl::Status& failure) {
  if (absl::IsResourceExhausted(failure)) WriteLogBack();
  PutBack(group);
  bool every_write_fits = !group.empty();
  for (auto write = group.begin(); write != group.end(); ++write) {
    if (write->IsRequest()) CommitAlone(write, failure);
    every_write_fits &= !IsOfTheDisk(*write->outcome);
  }
  if (every_write_fits) NoteHealth(absl::OkStatus());
}

absl::Status Store::CommitGroup(Writes::iterator first, Writes::iterator last) {
  busy_since_ = SteadyNow().time_since_epoch().count();
  bool begins_again = false;
  BeginGroup();
  for (auto write = first; write != last && writer_->status().ok(); ++write) {
    if (!write->outcome) begins_again = !Run(*write);
  }
  Failpoint("store.before_commit");
  writer_->Execute("COMMIT");
  Failpoint("store.after_commit");
  const absl::Status status = writer_->TakeStatus();
  if (status.ok()) return status;
  writer_->Rollback();
  // A request may have been refused because of a change that is rolled back.
  for (auto write = first; write != last; ++write) {
    if (write->IsRequest()) write->outcome.reset();
  }
  return begins_again ? CommitGroup(first, last) : status;
}

// A request that is refused is rolled back alone. Records have no savepoint, because it would take
// a tenth of their time, and hardly any is rejected.
bool Store::Run(Write& write) {
  if (write.IsRequest()) writer_->Run("SAVEPOINT request");
  try {
    write.change(*writer_);
  } catch (const std::bad_alloc&) {
    writer_->Fail(absl::UnavailableError("store: out of memory"));
  }
  const absl::Status status = writer_->status();
  const bool is_refused = !status.ok() && !IsOfTheDisk(status);
  if (is_refused) write.outcome = status;
  if (!write.IsRequest()) {
    if (is_refused) LogError(absl::StrCat("a record was rejected: ", status.message()));
    return !is_refused;
  }
  if (is_refused) {
    writer_->TakeStatus().IgnoreError();
    writer_->Run("ROLLBACK TO request");
  }
  writer_->Run("RELEASE request");
  return true;
}

// After a failure even an empty group writes something, because only a write shows that the disk
// works.
void Store::BeginGroup() {
  writer_->Execute("BEGIN IMMEDIATE");
  if (failing()) writer_->Execute(absl::StrCat("PRAGMA user_version = ", kSchemaVersion));
}

void Store::PutBack(Writes& group) {
  MutexLock lock(mutex_);
  Writes again;
  for (auto next = group.begin(); next != group.end();) {
    const auto write = next++;
    if (write->IsRequest() || write->outcome) continue;
    write->has_waited = true;
    again.splice(again.end(), group, write);
  }
  if (!closing_) waiting_.splice(waiting_.begin(), again);
  in_group_ = group.size();
}

void Store::CommitAlone(Writes::iterator request, const absl::Status& failure) {
  const auto end = std::next(request);
  absl::Status status = failure;
  if (absl::IsResourceExhausted(status)) status = CommitGroup(request, end);
  const bool frees_space = request->kind == Kind::kDeletion;
  if (absl::IsResourceExhausted(status) && frees_space && holds_reserve_) {
    ReleaseReserve();
    WriteLogBack();  // then the log starts from its beginning
    status = CommitGroup(request, end);
  }
  if (!request->outcome) request->outcome = status;
}

// Then the file may grow or shrink. Frames that cannot be written back now stay in the log.
void Store::WriteLogBack() {
  writer_->Execute("PRAGMA wal_checkpoint(PASSIVE)");
  writer_->TakeStatus().IgnoreError();
}

// The file is a database with one large value, so it is written like the store.
void Store::TakeReserve() {
  if (options_.reserve_bytes == 0) return;
  const auto file = Database::Open(reserve_path_, Database::Mode::kReadWrite);
  if (file.ok()) {
    (*file)->Execute(
        absl::StrCat("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;"
                     "CREATE TABLE IF NOT EXISTS reserve AS SELECT zeroblob(",
                     options_.reserve_bytes, ") AS zeros"));
  }
  // A file that is not complete, left by a crash, is an error here.
  holds_reserve_ = file.ok() && (*file)->status().ok();
  if (!holds_reserve_) ReleaseReserve();
}

void Store::ReleaseReserve() {
  holds_reserve_ = false;
  Database::RemoveFile(reserve_path_);
}

// ---- outcomes ----

// A step that fails is tried again later, unless the store is damaged: each step would find that.
void Store::NoteSweep(const absl::Status& status, bool has_advanced) {
  const bool advances = status.ok() && has_advanced;
  const bool is_failing = failing();
  // Waiting records may need the room of the reserve and that of the deleted job.
  if (is_failing && advances && holds_reserve_) ReleaseReserve();
  // The file gets shorter when the log is written back. A full disk has no room for a longer log.
  if (is_failing || !advances) WriteLogBack();
  if (!is_failing && !advances && !holds_reserve_) TakeReserve();
  if (absl::IsDataLoss(status)) {
    LogError(absl::StrCat("the space of deleted jobs cannot be freed: ", status.message()));
  }
  MutexLock lock(mutex_);
  sweep_advances_ = advances;
  next_sweep_ = advances ? SteadyNow() : kNever;
  if (IsOfTheDisk(status)) next_sweep_ = SteadyNow() + options_.retry;
}

void Store::Settle(const Writes& group) {
  {
    MutexLock lock(mutex_);
    in_group_ = 0;
    for (const Write& write : group) {
      bytes_ -= write.bytes;
      if (write.kind == Kind::kDeletion) next_sweep_ = SteadyNow();
      if (write.kind == Kind::kCheckpoint && !write.outcome) ++counts_.checkpoints_written;
    }
  }
  for (const Write& write : group) {
    if (write.done) write.done(write.outcome.value_or(absl::OkStatus()));
  }
  MutexLock lock(mutex_);
  written_.NotifyAll();
}

// Logs a failure once, and again only if the failure changes. The disk works again when no record
// that waited is left: on a full disk, a small group may fit. A close drops records that fail.
void Store::NoteHealth(const absl::Status& status) {
  MutexLock lock(mutex_);
  if (status.ok()) {
    ++counts_.commits;
    if (!failing_ || closing_ || std::ranges::any_of(waiting_, &Write::has_waited)) return;
    failing_ = false;
    failure_.clear();
    if (!waiting_.empty()) due_ = SteadyNow();
    return LogInfo("store: the disk works again");
  }
  failing_ = true;
  due_ = SteadyNow() + options_.retry;
  for (Write& write : waiting_) write.has_waited = !write.IsRequest();
  const std::string failure(status.message());
  if (std::exchange(failure_, failure) == failure) return;
  LogError(absl::StrCat(failure, "; computed results wait until the disk works again"));
}

}  // namespace ballpiston::server
