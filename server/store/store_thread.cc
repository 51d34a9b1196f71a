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

// Marks the checkpoints of points with a later write in the batch: they need not be written. A
// cluster reports many chunks of a point at a time, each with a checkpoint; if all of them were
// written, the chunks of first-hit that arrive in order would be accepted at a third of the rate
// (scheduler_benchmark). And while the disk fails, waiting checkpoints would soon take all the room
// of AwaitRoom, and the threads would stop computing.
template <typename Writes>
void MarkSuperseded(Writes& batch) {
  std::set<std::pair<int64_t, int64_t>> later;  // points that a later write supersedes
  for (auto write = batch.rbegin(); write != batch.rend(); ++write) {
    if (write->point < 0) continue;
    const bool is_first = later.emplace(write->job, write->point).second;
    write->superseded = write->is_checkpoint() && !is_first;
  }
}

}  // namespace

// ---- choice of the next writes ----

void Store::WriteUntilClosed() {
  while (AwaitWork()) WriteBatch(TakeBatch());
}

bool Store::RecordsAreDue(Clock::time_point now) const {
  if (closing_) return true;
  // On a full disk, records wait while space is being freed, because they would use it at once.
  if (failing_ && sweep_advances_) return false;
  const bool hurry = hurry_ && !records_.empty();
  if (failing_) return hurry || retry_time_ <= now;
  // Records share the group of a request. They are also due when half of the room is taken, because
  // AwaitRoom must not wait for the delay.
  const bool is_half_full =
      records_.size() > options_.max_pending / 2 || bytes_ > options_.max_pending_bytes / 2;
  return !requests_.empty() || hurry || is_half_full ||
         (!records_.empty() && records_.front().due <= now);
}

bool Store::SweepIsDue(Clock::time_point now) const {
  return next_sweep_ && !closing_ && *next_sweep_ <= now;
}

bool Store::BatchIsDue(Clock::time_point now) const {
  return !requests_.empty() || RecordsAreDue(now) || SweepIsDue(now);
}

std::optional<Store::Clock::time_point> Store::NextDue() const {
  std::optional<Clock::time_point> due = next_sweep_;
  const auto add = [&](Clock::time_point other) { due = std::min(due.value_or(other), other); };
  if (failing_ && !sweep_advances_) add(retry_time_);
  if (!failing_ && !records_.empty()) add(records_.front().due);
  return due;
}

bool Store::AwaitWork() {
  busy_since_ = 0;
  MutexLock lock(mutex_);
  while (!BatchIsDue(SteadyNow())) {
    if (const std::optional<Clock::time_point> due = NextDue()) {
      posted_.WaitUntil(mutex_, *due);
    } else {
      posted_.Wait(mutex_);
    }
  }
  return !closing_ || !records_.empty() || !requests_.empty();
}

Store::Batch Store::TakeBatch() {
  MutexLock lock(mutex_);
  const Clock::time_point now = SteadyNow();
  Batch batch = {.has_all = records_.empty() || RecordsAreDue(now)};
  if (batch.has_all) {
    batch.writes = std::exchange(records_, {});
    hurry_ = false;
  }
  std::move(requests_.begin(), requests_.end(), std::back_inserter(batch.writes));
  requests_.clear();
  if (SweepIsDue(now)) {
    const auto advances = std::make_shared<bool>(false);
    batch.writes.push_back(
        {.change = [advances](Database& database) { *advances = SweepStep(database); },
         .done = [this, advances](const absl::Status& done) { NoteSweep(done, *advances); },
         .is_request = true,
         .frees_space = true});
  }
  in_batch_ = batch.writes.size();
  return batch;
}

// ---- writing them ----

void Store::WriteBatch(Batch batch) {
  Writes& writes = batch.writes;
  MarkSuperseded(writes);
  size_t first = 0;
  do {  // an empty batch tests the disk
    const size_t last = GroupEnd(writes, first);
    const absl::Status status = CommitGroup(writes, first, last);
    if (!status.ok()) return SettleFailed(std::move(batch), first, status);
    if (last == writes.size() && batch.has_all) NoteHealth(status);  // before the callers know
    Settle(writes, std::exchange(first, last), last);
  } while (first < writes.size());
}

size_t Store::GroupEnd(const Writes& batch, size_t first) const {
  const size_t most = failing() ? kMostBytesOnFailingDisk : kMostGroupBytes;
  size_t end = first, bytes = 0;
  while (end < batch.size() && (end == first || bytes + batch[end].bytes <= most)) {
    bytes += batch[end++].bytes;
  }
  return end;
}

absl::Status Store::CommitGroup(Writes& batch, size_t first, size_t last) {
  busy_since_ = SteadyNow().time_since_epoch().count();
  bool has_rejected = false;
  BeginGroup();
  for (size_t i = first; i < last && writer_->status().ok(); ++i) {
    Write& write = batch[i];
    if (write.superseded || write.outcome) continue;
    if (write.is_request) RunRequest(write);
    if (!write.is_request) has_rejected = !RunRecord(write);
  }
  Failpoint("store.before_commit");
  writer_->Execute("COMMIT");
  Failpoint("store.after_commit");
  const absl::Status status = writer_->TakeStatus();
  if (status.ok()) {
    NoteCommitted(batch, first, last);
    return status;
  }
  writer_->Rollback();
  // A request may have been refused because of a change that is rolled back.
  for (size_t i = first; i < last; ++i) {
    if (batch[i].is_request) batch[i].outcome.reset();
  }
  return has_rejected ? CommitGroup(batch, first, last) : status;  // without the rejected record
}

void Store::NoteCommitted(Writes& batch, size_t first, size_t last) {
  MutexLock lock(mutex_);
  ++counts_.commits;
  for (size_t i = first; i < last; ++i) {
    Write& write = batch[i];
    if (write.is_checkpoint() && !write.superseded && !write.outcome) ++counts_.checkpoints_written;
    if (!write.outcome) write.outcome = absl::OkStatus();
  }
}

absl::Status Store::RunChange(const Change& change) {
  try {
    change(*writer_);
  } catch (const std::bad_alloc&) {
    writer_->Fail(absl::UnavailableError("store: out of memory"));
  }
  return IsOfTheDisk(writer_->status()) ? absl::OkStatus() : writer_->status();
}

// A request that is refused is rolled back alone.
void Store::RunRequest(Write& request) {
  writer_->Run("SAVEPOINT request");
  if (!RunChange(request.change).ok()) {
    request.outcome = writer_->TakeStatus();
    writer_->Run("ROLLBACK TO request");
  }
  writer_->Run("RELEASE request");
}

// Records have no savepoint, because it would take a tenth of their time, and hardly any is
// rejected.
bool Store::RunRecord(Write& record) {
  const absl::Status rejection = RunChange(record.change);
  if (rejection.ok()) return true;
  record.outcome = rejection;
  LogError(absl::StrCat("a record was rejected: ", rejection.message()));
  return false;
}

// After a failure even an empty group writes something, because only a write shows that the disk
// works.
void Store::BeginGroup() {
  writer_->Execute("BEGIN IMMEDIATE");
  if (failing()) writer_->Execute(absl::StrCat("PRAGMA user_version = ", kSchemaVersion));
}

void Store::TryAgain(Writes& batch, size_t request, const absl::Status& failure) {
  Write& write = batch[request];
  absl::Status status = failure;
  if (absl::IsResourceExhausted(status)) status = CommitGroup(batch, request, request + 1);
  if (absl::IsResourceExhausted(status) && write.frees_space && holds_reserve_) {
    ReleaseReserve();
    WriteLogBack();  // then the log starts from its beginning
    status = CommitGroup(batch, request, request + 1);
  }
  if (!status.ok()) write.outcome = status;
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
  next_sweep_.reset();
  if (advances) next_sweep_ = SteadyNow();
  if (IsOfTheDisk(status)) next_sweep_ = SteadyNow() + options_.retry;
}

void Store::Settle(Writes& batch, size_t first, size_t last) {
  {
    MutexLock lock(mutex_);
    in_batch_ -= last - first;
    for (size_t i = first; i < last; ++i) {
      bytes_ -= batch[i].bytes;
      if (batch[i].frees_space) next_sweep_ = SteadyNow();
    }
  }
  for (size_t i = first; i < last; ++i) {
    Write& write = batch[i];
    if (write.done) write.done(write.outcome.value_or(absl::OkStatus()));
    write.change = nullptr;  // releases its data; other groups of the batch may take long
    write.done = nullptr;
  }
  MutexLock lock(mutex_);
  written_.NotifyAll();
}

void Store::SettleFailed(Batch batch, size_t first, const absl::Status& failure) {
  NoteHealth(failure);
  if (absl::IsResourceExhausted(failure)) WriteLogBack();
  Writes& writes = batch.writes;
  bool has_failed = !batch.has_all || first == writes.size();
  Writes again;
  for (size_t i = first; i < writes.size(); ++i) {
    Write& write = writes[i];
    if (write.is_request) TryAgain(writes, i, failure);
    if (!write.outcome && !write.superseded) {
      again.push_back(std::move(write));
      continue;
    }
    has_failed |= write.outcome && IsOfTheDisk(*write.outcome);
    Settle(writes, i, i + 1);
  }
  if (!has_failed && again.empty()) NoteHealth(absl::OkStatus());  // every write fitted alone
  Requeue(std::move(again));
}

void Store::Requeue(Writes again) {
  MutexLock lock(mutex_);
  in_batch_ = 0;
  if (!closing_) {
    records_.insert(records_.begin(), std::make_move_iterator(again.begin()),
                    std::make_move_iterator(again.end()));
  }
  written_.NotifyAll();
}

// Logs a failure once, and again only if the failure changes.
void Store::NoteHealth(const absl::Status& status) {
  MutexLock lock(mutex_);
  if (!status.ok()) {
    retry_time_ = SteadyNow() + options_.retry;
    const std::string failure(status.message());
    if (std::exchange(failure_, failure) != failure) {
      LogError(absl::StrCat(failure, "; computed results wait until the disk works again"));
    }
  } else if (failing_) {
    failure_.clear();
    LogInfo("store: the disk works again");
  }
  failing_ = !status.ok();
}

}  // namespace ballpiston::server
