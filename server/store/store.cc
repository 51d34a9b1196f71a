#include "server/store/store.h"

#include <algorithm>
#include <iterator>
#include <new>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/observability/failpoint.h"
#include "server/observability/log.h"
#include "server/store/schema.h"
#include "server/store/sweeper.h"

namespace ballpiston::server {
namespace {

// Limits the time of a transaction, and the part of the log that may not fit into the file. While
// the disk fails, groups are small, because a small group may fit where a large one does not.
constexpr size_t kMostGroupBytes = 2 << 20;
constexpr size_t kMostBytesOnFailingDisk = 128 << 10;

constexpr std::chrono::seconds kBetweenReserves(60);
constexpr std::chrono::milliseconds kBetweenLooks(100);  // whether the disk hangs

absl::Status Stalled() {
  return absl::UnavailableError("store: the disk does not answer; retry later");
}

// The outcome of a write. The thread that posted the write waits for it.
class Outcome {
 public:
  void Tell(const absl::Status& status) {
    MutexLock lock(mutex_);
    status_ = status;
    told_.NotifyAll();
  }
  absl::Status Await() {
    MutexLock lock(mutex_);
    while (!status_) told_.Wait(mutex_);
    return *status_;
  }

 private:
  Mutex mutex_;
  Condition told_;
  std::optional<absl::Status> status_ ABSL_GUARDED_BY(mutex_);
};

absl::Status Closed() { return absl::UnavailableError("store: closed"); }

std::string Text(const absl::Status& status) {
  return {status.message().data(), status.message().size()};
}

// Marks the checkpoints of points with a later write in the batch.
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

absl::StatusOr<std::unique_ptr<Store>> Store::Open(const std::string& path, Options options) {
  auto writer = OpenStoreFile(path, options.vfs);
  if (!writer.ok()) return writer.status();
  auto identity = (*writer)->Text("SELECT identity FROM server");
  if (!identity.ok()) return identity.status();
  auto store = std::unique_ptr<Store>(
      new Store(*std::move(writer), std::move(options), path, *std::move(identity)));
  for (int i = 0; i < store->options_.readers; ++i) {
    const absl::Status added = store->readers_.Add(path, store->options_.vfs);
    if (!added.ok()) return added;
  }
  store->Start();
  return store;
}

Store::Store(std::unique_ptr<Database> writer, Options options, std::string path,
             std::string identity)
    : options_(std::move(options)),
      path_(std::move(path)),
      identity_(std::move(identity)),
      writer_(std::move(writer)),
      reserve_(path_, options_.reserve_bytes, options_.vfs) {}

void Store::Start() {
  reserve_.Take();
  thread_ = Thread([this] { WriteUntilClosed(); });
}

Store::~Store() { Close(); }

// ---- posting ----

absl::Status Store::Commit(Change change) { return CommitRequest({.change = std::move(change)}); }

absl::Status Store::CommitDeletion(Change change) {
  return CommitRequest({.change = std::move(change), .frees_space = true});
}

absl::Status Store::CommitRequest(Write request) {
  if (stalled()) return Stalled();
  // Shared: the store's thread may still be inside Tell when this function returns.
  const auto outcome = std::make_shared<Outcome>();
  request.is_request = true;
  request.done = [outcome](const absl::Status& status) { outcome->Tell(status); };
  Post(std::move(request));
  return outcome->Await();
}

void Store::Record(Change change, Done done) {
  Post({.change = std::move(change), .done = std::move(done)});
}

void Store::RecordSoon(Change change, Done done) {
  Post({.change = std::move(change), .done = std::move(done)}, true);
}

void Store::RecordCheckpoint(int64_t job, int64_t point, uint64_t chunk,
                             std::function<std::string()> serialize, size_t bytes) {
  auto change = [=, serialize = std::move(serialize)](Database& database) {
    Failpoint("checkpoint.before_write");
    return WriteCheckpoint(database, job, point, static_cast<int64_t>(chunk), serialize());
  };
  Post({.change = std::move(change), .bytes = bytes, .job = job, .point = point});
}

void Store::RecordChunk(int64_t job, int64_t point, uint64_t chunk, std::string record) {
  const size_t bytes = record.size();
  auto change = [=, record = std::move(record)](Database& database) {
    return InsertChunk(database, job, point, static_cast<int64_t>(chunk), record);
  };
  Post({.change = std::move(change), .bytes = bytes});
}

void Store::RecordResult(int64_t job, PointRow row, std::function<void(int64_t number)> stored) {
  const auto number = std::make_shared<int64_t>(0);
  Write write = {.bytes = row.result.size() + row.details.size(),
                 .job = job,
                 .point = row.point,
                 .is_result = true};
  write.change = [job, row = std::move(row), number](Database& database) {
    const absl::StatusOr<int64_t> inserted = InsertResult(database, job, row);
    *number = inserted.value_or(0);
    return inserted.status();
  };
  write.done = [number, stored = std::move(stored)](const absl::Status& status) {
    if (status.ok() && stored && *number > 0) stored(*number);
  };
  Post(std::move(write));
}

void Store::Post(Write write, bool soon) {
  const Clock::time_point now = SteadyNow();
  write.due = now + options_.delay;
  {
    MutexLock lock(mutex_);
    if (!closing_) {
      hurry_ |= soon;
      recorded_ += write.is_request ? 0 : 1;
      bytes_ += write.bytes;
      (write.is_request ? requests_ : records_).push_back(std::move(write));
      // The store's thread knows already when the other records are due.
      if (records_.size() == 1 || BatchIsDue(now)) posted_.NotifyOne();
      return;
    }
  }
  if (write.done) write.done(Closed());
}

absl::Status Store::Flush() {
  MutexLock lock(mutex_);
  const int64_t last = recorded_, rejected_before = rejected_;
  hurry_ |= settled_ < last;
  posted_.NotifyOne();
  while (!closing_ && settled_ < last && rejected_ == rejected_before) {
    if (stalled()) return Stalled();
    written_.WaitUntil(mutex_, SteadyNow() + kBetweenLooks);
  }
  if (closing_) return Closed();
  return settled_ >= last ? absl::OkStatus() : absl::UnavailableError(failure_);
}

void Store::AwaitSwept() {
  MutexLock lock(mutex_);
  while (next_sweep_ && !closing_) written_.Wait(mutex_);
}

bool Store::IsFull() const {
  return records_.size() + requests_.size() + in_batch_ > options_.max_pending ||
         bytes_ > options_.max_pending_bytes;
}

void Store::AwaitRoom() {
  MutexLock lock(mutex_);
  while (!stop_waiting_ && !closing_ && IsFull()) written_.Wait(mutex_);
}

void Store::StopWaiting() {
  MutexLock lock(mutex_);
  stop_waiting_ = true;
  written_.NotifyAll();
}

void Store::Close() {
  {
    MutexLock lock(mutex_);
    closing_ = true;
    posted_.NotifyAll();
    written_.NotifyAll();
  }
  if (!thread_.joinable()) return;
  thread_.join();
  readers_.Close();
  Failpoint("stop.before_checkpoint");
  writer_.reset();  // last: the last connection to close checkpoints
}

bool Store::failing() const {
  MutexLock lock(mutex_);
  return failing_;
}

bool Store::stalled() const {
  const Clock::rep since = busy_since_;
  return since != 0 && SteadyNow() - Clock::time_point(Clock::duration(since)) > options_.stall;
}

Store::Counts Store::counts() const {
  MutexLock lock(mutex_);
  Counts counts = counts_;
  counts.pending_writes = static_cast<int64_t>(records_.size() + requests_.size() + in_batch_);
  return counts;
}

// ---- choice of the next writes ----

void Store::WriteUntilClosed() {
  Sweep();  // goes on where the last process stopped
  while (AwaitWork()) {
    if (std::optional<Batch> batch = TakeBatch()) WriteBatch(*std::move(batch));
    Sweep();
  }
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

bool Store::BatchIsDue(Clock::time_point now) const {
  return !requests_.empty() || RecordsAreDue(now);
}

bool Store::SweepIsDue(Clock::time_point now) const {
  return next_sweep_ && !closing_ && *next_sweep_ <= now;
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
  for (auto now = SteadyNow(); !BatchIsDue(now) && !SweepIsDue(now); now = SteadyNow()) {
    if (const std::optional<Clock::time_point> due = NextDue()) {
      posted_.WaitUntil(mutex_, *due);
    } else {
      posted_.Wait(mutex_);
    }
  }
  return !closing_ || !records_.empty() || !requests_.empty();
}

std::optional<Store::Batch> Store::TakeBatch() {
  MutexLock lock(mutex_);
  const Clock::time_point now = SteadyNow();
  if (!BatchIsDue(now)) return std::nullopt;
  Batch batch = {.has_all = records_.empty() || RecordsAreDue(now)};
  if (batch.has_all) {
    batch.writes = std::exchange(records_, {});
    hurry_ = false;
  }
  std::move(requests_.begin(), requests_.end(), std::back_inserter(batch.writes));
  requests_.clear();
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
  NoteProgress();
  while (true) {
    Write* culprit = nullptr;
    const absl::Status status = TryGroup(batch, first, last, culprit);
    if (status.ok()) break;
    writer_->Execute("ROLLBACK").IgnoreError();  // SQLite may have done so already
    if (culprit == nullptr || IsOfTheDisk(status)) return status;
    culprit->outcome = status;
    if (!culprit->is_request) LogError(absl::StrCat("a record was rejected: ", Text(status)));
  }
  MutexLock lock(mutex_);
  ++counts_.commits;
  for (size_t i = first; i < last; ++i) {
    Write& write = batch[i];
    if (write.is_checkpoint() && !write.superseded && !write.outcome) ++counts_.checkpoints_written;
    if (!write.outcome) write.outcome = absl::OkStatus();
  }
  return absl::OkStatus();
}

absl::Status Store::TryGroup(Writes& batch, size_t first, size_t last, Write*& culprit) {
  absl::Status status = BeginGroup();
  for (size_t i = first; i < last && status.ok(); ++i) {
    Write& write = batch[i];
    if (write.superseded || write.outcome) continue;
    try {
      status = write.change(*writer_);
    } catch (const std::bad_alloc&) {
      status = absl::UnavailableError("store: out of memory");
    }
    // A change may treat an error as an answer, but the group must not go on without a transaction.
    if (status.ok() && !writer_->InTransaction()) {
      status = absl::UnavailableError("store: SQLite rolled the transaction back");
    }
    if (!status.ok()) culprit = &write;
  }
  Failpoint("store.before_commit");
  if (status.ok()) status = writer_->Execute("COMMIT");
  Failpoint("store.after_commit");
  return status;
}

// After a failure even an empty group writes something, because only a write shows that the disk
// works.
absl::Status Store::BeginGroup() {
  const absl::Status begun = writer_->Execute("BEGIN IMMEDIATE");
  if (!begun.ok() || !failing()) return begun;
  return writer_->Execute(absl::StrCat("PRAGMA user_version = ", kSchemaVersion));
}

void Store::TryAgain(Writes& batch, size_t request, const absl::Status& failure) {
  Write& write = batch[request];
  if (write.outcome) return;  // refused
  absl::Status status = failure;
  if (absl::IsResourceExhausted(status)) status = CommitGroup(batch, request, request + 1);
  if (absl::IsResourceExhausted(status) && write.frees_space && reserve_.held()) {
    ReleaseReserve();
    status = CommitGroup(batch, request, request + 1);
  }
  if (!status.ok()) write.outcome = status;
}

// Then the file may grow, and the log starts from its beginning.
void Store::ReleaseReserve() {
  reserve_.Release();
  WriteLogBack();
}

// Frames that cannot be written back now stay in the log.
void Store::WriteLogBack() { writer_->Execute("PRAGMA wal_checkpoint(PASSIVE)").IgnoreError(); }

void Store::Sweep() {
  bool is_failing = false, has_advanced = false;
  {
    MutexLock lock(mutex_);
    if (!SweepIsDue(SteadyNow())) return;
    is_failing = failing_;
    has_advanced = sweep_advances_;
  }
  NoteProgress();
  const absl::StatusOr<bool> swept = SweepWithReserve();
  const bool has_ended = swept.ok() && !*swept;
  // Waiting records may need the room of the reserve and that of the deleted job.
  if (is_failing && swept.ok() && *swept && reserve_.held()) reserve_.Release();
  // The file gets shorter when the log is written back. A full disk has no room for a longer log.
  if (is_failing || !swept.ok() || (has_advanced && has_ended)) WriteLogBack();
  if (has_ended && !is_failing) TakeReserve();
  NoteSweep(swept);
}

// One step. If it has no room, the reserve is released.
absl::StatusOr<bool> Store::SweepWithReserve() {
  const absl::StatusOr<bool> swept = SweepStep(*writer_);
  if (!absl::IsResourceExhausted(swept.status()) || !reserve_.held()) return swept;
  ReleaseReserve();
  return SweepStep(*writer_);
}

void Store::TakeReserve() {
  if (reserve_.held() || next_reserve_ > SteadyNow()) return;
  reserve_.Take();
  next_reserve_ = SteadyNow() + kBetweenReserves;
}

// A step that fails is tried again later, unless the store is damaged: each step would find that.
void Store::NoteSweep(const absl::StatusOr<bool>& swept) {
  const bool is_damage = absl::IsDataLoss(swept.status());
  if (is_damage) {
    LogError(absl::StrCat("the space of deleted jobs cannot be freed: ", Text(swept.status())));
  } else if (!swept.ok()) {
    NoteHealth(swept.status());
  }
  MutexLock lock(mutex_);
  sweep_is_damaged_ = is_damage;
  sweep_advances_ = swept.ok() && *swept;
  next_sweep_.reset();
  if (sweep_advances_) next_sweep_ = SteadyNow();
  if (!swept.ok() && !is_damage) next_sweep_ = SteadyNow() + options_.retry;
  written_.NotifyAll();
}

// ---- outcomes ----

void Store::Settle(Writes& batch, size_t first, size_t last) {
  {
    MutexLock lock(mutex_);
    in_batch_ -= last - first;
    for (size_t i = first; i < last; ++i) bytes_ -= batch[i].bytes;
    if (!next_sweep_ && !sweep_is_damaged_) next_sweep_ = SteadyNow();
  }
  int64_t records = 0;
  for (size_t i = first; i < last; ++i) {
    Write& write = batch[i];
    if (write.done) write.done(write.outcome.value_or(absl::OkStatus()));
    write.change = nullptr;  // releases its data; other groups of the batch may take long
    write.done = nullptr;
    records += write.is_request ? 0 : 1;
  }
  MutexLock lock(mutex_);
  settled_ += records;
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
    // Records are settled in their order: Flush counts them.
    const bool is_settled = write.outcome || write.superseded;
    if (is_settled && (write.is_request || again.empty())) {
      has_failed |= write.outcome && IsOfTheDisk(*write.outcome);
      Settle(writes, i, i + 1);
    } else {
      again.push_back(std::move(write));
    }
  }
  if (!has_failed && again.empty()) NoteHealth(absl::OkStatus());  // every write fitted alone
  Requeue(std::move(again));
}

void Store::Requeue(Writes again) {
  MutexLock lock(mutex_);
  in_batch_ = 0;
  if (again.empty()) return;
  ++rejected_;
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
    ++counts_.failures;
    retry_time_ = SteadyNow() + options_.retry;
    if (std::exchange(failure_, Text(status)) != Text(status)) {
      LogError(absl::StrCat(Text(status), "; computed results wait until the disk works again"));
    }
  } else if (failing_) {
    failure_.clear();
    LogInfo("store: the disk works again");
  }
  failing_ = !status.ok();
}

}  // namespace ballpiston::server
