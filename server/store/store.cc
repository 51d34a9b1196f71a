#include "server/store/store.h"

#include <algorithm>
#include <future>
#include <iterator>
#include <new>
#include <set>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "server/observability/failpoint.h"
#include "server/observability/log.h"
#include "server/store/schema.h"

namespace ballpiston::server {
namespace {

// The smallest group of records on a full disk. It is larger than one, so that a group that does
// not fit leaves some room for requests.
constexpr size_t kSmallestGroup = 32;

// Limits the time of a transaction, and the part of the log that may not fit into the file.
constexpr size_t kMostGroupBytes = 2 << 20;

constexpr std::chrono::seconds kBetweenReserves(60);

absl::Status Stalled() {
  return absl::UnavailableError("store: the disk does not answer; retry later");
}

absl::Status Closed() { return absl::UnavailableError("store: closed"); }

std::string Text(const absl::Status& status) {
  return {status.message().data(), status.message().size()};
}

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> Store::Open(const std::string& path, Options options) {
  auto writer = OpenStoreFile(path, options.vfs);
  if (!writer.ok()) return writer.status();
  std::vector<std::unique_ptr<Database>> readers;
  for (int i = 0; i < options.readers; ++i) {
    auto reader = Database::Open(path, Database::Mode::kReadOnly, options.vfs);
    if (!reader.ok()) return reader.status();
    readers.push_back(*std::move(reader));
  }
  auto identity = readers.front()->Text("SELECT identity FROM server");
  if (!identity.ok()) return identity.status();
  return std::unique_ptr<Store>(new Store(*std::move(writer), std::move(readers),
                                          std::move(options), path, *std::move(identity)));
}

Store::Store(std::unique_ptr<Database> writer, std::vector<std::unique_ptr<Database>> readers,
             Options options, std::string path, std::string identity)
    : options_(std::move(options)),
      path_(std::move(path)),
      identity_(std::move(identity)),
      writer_(std::move(writer)),
      disk_calls_(writer_->WatchDisk()),
      reserve_(path_, options_.reserve_bytes, options_.vfs, *disk_calls_),
      free_readers_(std::move(readers)),
      readers_(free_readers_.size()) {
  reserve_.Take();
  thread_ = std::thread([this] { WriteUntilClosed(); });
}

Store::~Store() { Close(); }

// ---- posting ----

absl::Status Store::Commit(Change change, Done done) {
  return Await({.change = std::move(change), .done = std::move(done)});
}

absl::Status Store::CommitDeletion(Change change, Done done) {
  return Await({.change = std::move(change), .done = std::move(done), .frees_space = true});
}

absl::Status Store::Flush() {
  return Await({.change = [](Database&) { return absl::OkStatus(); }, .ordered = true});
}

void Store::AwaitSwept() {
  MutexLock lock(mutex_);
  while (!swept_ && !sweep_is_damaged_ && !closing_) written_.Wait(mutex_);
}

absl::Status Store::Await(Write write) {
  if (stalled()) {
    if (write.done) write.done(Stalled());
    return Stalled();
  }
  // Shared: the store's thread may still be inside set_value when this function returns.
  auto committed = std::make_shared<std::promise<absl::Status>>();
  std::future<absl::Status> result = committed->get_future();
  write.urgent = true;
  write.lasting = false;
  write.done = [committed, done = std::move(write.done)](const absl::Status& status) {
    if (done) done(status);
    committed->set_value(status);
  };
  Post(std::move(write));
  return result.get();
}

void Store::Record(Change change, Done done) {
  Write write;
  write.change = std::move(change);
  write.done = std::move(done);
  Post(std::move(write));
}

void Store::RecordSoon(Change change, Done done) {
  Write write;
  write.change = std::move(change);
  write.done = std::move(done);
  write.urgent = true;
  Post(std::move(write));
}

void Store::RecordCheckpoint(int64_t job, int64_t point, uint64_t chunk,
                             std::function<std::string()> serialize, size_t bytes) {
  Write write;
  write.job = job;
  write.point = point;
  write.bytes = bytes;
  write.change = [=, serialize = std::move(serialize)](Database& database) {
    Failpoint("checkpoint.before_write");
    return WriteCheckpoint(database, job, point, static_cast<int64_t>(chunk), serialize());
  };
  Post(std::move(write));
}

void Store::RecordChunk(int64_t job, int64_t point, uint64_t chunk, std::string record) {
  Write write;
  write.bytes = record.size();
  write.change = [=, record = std::move(record)](Database& database) {
    return InsertChunk(database, job, point, static_cast<int64_t>(chunk), record);
  };
  Post(std::move(write));
}

void Store::RecordResult(int64_t job, PointRow row, std::function<void(int64_t number)> stored) {
  const auto number = std::make_shared<int64_t>(0);
  Write write;
  write.job = job;
  write.point = row.point;
  write.is_result = true;
  write.bytes = row.result.size() + row.details.size();
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

void Store::Post(Write write) {
  write.due = Clock::now() + options_.delay;
  {
    MutexLock lock(mutex_);
    if (!closing_) {
      urgent_ += write.urgent ? 1 : 0;
      requests_ += write.lasting ? 0 : 1;
      ordered_ += write.ordered ? 1 : 0;
      bytes_ += write.bytes;
      pending_.push_back(std::move(write));
      // The store's thread knows already when the other writes are due.
      if (pending_.size() == 1 || BatchIsDue(Clock::now())) posted_.NotifyOne();
      return;
    }
  }
  if (write.done) write.done(Closed());
}

absl::Status Store::Read(absl::FunctionRef<absl::Status(Database&)> read) {
  std::unique_ptr<Database> reader = TakeReader();
  if (reader == nullptr) return Closed();
  const absl::Cleanup give_back = [&] { GiveBack(std::move(reader)); };
  absl::Status status = reader->Execute("BEGIN");
  if (status.ok()) status = read(*reader);
  reader->Execute("ROLLBACK").IgnoreError();  // SQLite may have done so already
  return status;
}

std::unique_ptr<Database> Store::TakeReader() {
  MutexLock lock(readers_mutex_);
  while (readers_ > 0 && free_readers_.empty()) reader_is_free_.Wait(readers_mutex_);
  if (readers_ == 0) return nullptr;
  std::unique_ptr<Database> reader = std::move(free_readers_.back());
  free_readers_.pop_back();
  return reader;
}

void Store::GiveBack(std::unique_ptr<Database> reader) {
  MutexLock lock(readers_mutex_);
  free_readers_.push_back(std::move(reader));
  reader_is_free_.NotifyAll();
}

// Waits for the connections in use.
void Store::CloseReaders() {
  MutexLock lock(readers_mutex_);
  while (free_readers_.size() < readers_) reader_is_free_.Wait(readers_mutex_);
  free_readers_.clear();
  readers_ = 0;
  reader_is_free_.NotifyAll();
}

bool Store::IsFull() const {
  return pending_.size() + in_batch_ > options_.max_pending || bytes_ > options_.max_pending_bytes;
}

void Store::AwaitRoom() {
  MutexLock lock(mutex_);
  while (!stop_waiting_ && !closing_ && IsFull()) written_.Wait(mutex_);
}

void Store::StopWaiting() {
  MutexLock lock(mutex_);
  stop_waiting_ = true;
  posted_.NotifyAll();
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
  CloseReaders();
  Failpoint("stop.before_checkpoint");
  writer_.reset();  // last: the last connection to close checkpoints
}

bool Store::failing() const {
  MutexLock lock(mutex_);
  return failing_;
}

bool Store::stalled() const { return disk_calls_->Waiting() > options_.stall; }

int64_t Store::commits() const {
  MutexLock lock(mutex_);
  return commits_;
}

int64_t Store::checkpoints_written() const {
  MutexLock lock(mutex_);
  return checkpoints_written_;
}

int64_t Store::failures() const {
  MutexLock lock(mutex_);
  return failures_;
}

int64_t Store::pending_writes() const {
  MutexLock lock(mutex_);
  return static_cast<int64_t>(pending_.size() + in_batch_);
}

// ---- choice of the next writes ----

void Store::WriteUntilClosed() {
  Sweep();  // goes on where the last process stopped
  while (AwaitWork()) {
    if (std::optional<Batch> batch = TakeBatch()) {
      MarkSuperseded(batch->writes);
      const absl::Status status = CommitBatch(*batch);
      SettleRest(std::move(batch->writes), status);
    }
    Sweep();
  }
}

bool Store::BatchIsDue(Clock::time_point now) const {
  if (closing_) return true;
  // On a full disk, records wait while space is being freed, because they would use it at once.
  const bool records_wait = failing_ && sweep_advances_ && !stop_waiting_;
  if (requests_ > (records_wait ? ordered_ : 0)) return true;
  if (failing_) return !stop_waiting_ && !records_wait && retry_time_ <= now;
  // A batch is also due when half of the room is taken: AwaitRoom must not wait for the delay.
  const bool half_full =
      pending_.size() > options_.max_pending / 2 || bytes_ > options_.max_pending_bytes / 2;
  return urgent_ > 0 || half_full || (!pending_.empty() && pending_.front().due <= now);
}

bool Store::SweepIsDue(Clock::time_point now) const {
  return sweeping_ && !sweep_is_damaged_ && !closing_ && next_sweep_ <= now;
}

std::optional<Store::Clock::time_point> Store::NextDue() const {
  std::optional<Clock::time_point> due;
  if (failing_ && !stop_waiting_ && !sweep_advances_) due = retry_time_;
  if (!failing_ && !pending_.empty()) due = pending_.front().due;
  const bool sweeps = sweeping_ && !sweep_is_damaged_ && !closing_;
  if (sweeps) due = std::min(due.value_or(next_sweep_), next_sweep_);
  return due;
}

bool Store::AwaitWork() {
  MutexLock lock(mutex_);
  for (auto now = Clock::now(); !BatchIsDue(now) && !SweepIsDue(now); now = Clock::now()) {
    if (const std::optional<Clock::time_point> due = NextDue()) {
      posted_.WaitUntil(mutex_, *due);
    } else {
      posted_.Wait(mutex_);
    }
  }
  return !closing_ || !pending_.empty();
}

std::optional<Store::Batch> Store::TakeBatch() {
  MutexLock lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (!BatchIsDue(now)) return std::nullopt;
  const bool records_wait = failing_ && sweep_advances_ && !stop_waiting_ && !closing_;
  const bool retry = closing_ || retry_time_ <= now || ordered_ > 0;
  return TakePending(!records_wait && (!failing_ || retry));
}

// While the disk fails and the next retry is not due, takes only requests, which are few and small.
Store::Batch Store::TakePending(bool whole) {
  Batch batch;
  batch.whole = whole;
  batch.writes = whole ? std::exchange(pending_, {}) : TakeRequests();
  urgent_ -= whole ? urgent_ : batch.writes.size();
  requests_ = whole ? 0 : ordered_;
  if (whole) ordered_ = 0;
  in_batch_ = batch.writes.size();
  return batch;
}

Store::Writes Store::TakeRequests() {
  const auto first =
      std::stable_partition(pending_.begin(), pending_.end(),
                            [](const Write& write) { return write.lasting || write.ordered; });
  Writes requests(std::make_move_iterator(first), std::make_move_iterator(pending_.end()));
  pending_.erase(first, pending_.end());
  return requests;
}

void Store::MarkSuperseded(Writes& batch) const {
  std::set<std::pair<int64_t, int64_t>> later;  // points that a later write supersedes
  for (auto write = batch.rbegin(); write != batch.rend(); ++write) {
    if (write->point < 0) continue;
    const bool is_first = later.emplace(write->job, write->point).second;
    write->superseded = write->is_checkpoint() && !is_first;
  }
}

// ---- writing them ----

size_t Store::GroupEnd(const Writes& batch, size_t first, size_t most) {
  size_t end = first, bytes = 0;
  while (end < batch.size() && end - first < most &&
         (end == first || bytes + batch[end].bytes <= kMostGroupBytes)) {
    bytes += batch[end++].bytes;
  }
  return end;
}

absl::Status Store::CommitBatch(Batch& batch) {
  Writes& writes = batch.writes;
  size_t first = 0;
  size_t group = std::max<size_t>(writes.size(), 1);
  absl::Status status;
  do {
    const size_t last = GroupEnd(writes, first, group);
    status = CommitGroup(writes, first, last);
    if (status.ok()) {
      if (last == writes.size() && batch.whole)
        NoteHealth(status);  // before the callers hear of it
      Settle(writes, first, last, status);
      first = last;
    } else if (absl::IsResourceExhausted(status)) {
      WriteLogBack();
      if (group <= kSmallestGroup) break;
      group = std::max(kSmallestGroup, group / 2);
    }
  } while (first < writes.size() && (status.ok() || absl::IsResourceExhausted(status)));
  if (status.ok()) return status;
  if (absl::IsResourceExhausted(status)) status = CommitRequestsAlone(writes, first, status);
  if (batch.whole) NoteHealth(status);
  return status;
}

// Commits the requests from `first` on, one by one, because the disk is full. OK if no write has to
// wait.
absl::Status Store::CommitRequestsAlone(Writes& batch, size_t first, const absl::Status& full) {
  absl::Status failed = first < batch.size() ? absl::OkStatus() : full;
  for (size_t i = first; i < batch.size(); ++i) {
    const bool alone = !batch[i].lasting && !batch[i].ordered;
    const absl::Status status = alone ? CommitRequest(batch, i) : full;
    if (!status.ok()) failed = status;
    if (status.ok()) Settle(batch, i, i + 1, status);
  }
  return failed;
}

absl::Status Store::CommitRequest(Writes& batch, size_t request) {
  const absl::Status status = CommitGroup(batch, request, request + 1);
  const bool needs_room =
      absl::IsResourceExhausted(status) && batch[request].frees_space && reserve_.held();
  if (!needs_room) return status;
  reserve_.Release();
  WriteLogBack();  // the file may grow now, and the log starts from its beginning
  return CommitGroup(batch, request, request + 1);
}

absl::Status Store::CommitGroup(Writes& batch, size_t first, size_t last) {
  while (true) {
    std::optional<size_t> culprit;
    const absl::Status status = TryGroup(batch, first, last, culprit);
    if (status.ok()) break;
    writer_->Execute("ROLLBACK").IgnoreError();  // SQLite may have done so already
    if (!culprit || IsOfTheDisk(status)) return status;
    Write& refused = batch[*culprit];
    refused.outcome = status;
    if (refused.lasting) LogError(absl::StrCat("a record was rejected: ", Text(status)));
  }
  MutexLock lock(mutex_);
  ++commits_;
  for (size_t i = first; i < last; ++i) {
    Write& write = batch[i];
    if (write.is_checkpoint() && !write.superseded && !write.outcome) ++checkpoints_written_;
    if (!write.outcome) write.outcome = absl::OkStatus();
  }
  return absl::OkStatus();
}

absl::Status Store::TryGroup(Writes& batch, size_t first, size_t last,
                             std::optional<size_t>& culprit) {
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
    if (!status.ok()) culprit = i;
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

// Frames that cannot be written back now stay in the log.
void Store::WriteLogBack() { writer_->Execute("PRAGMA wal_checkpoint(PASSIVE)").IgnoreError(); }

void Store::Sweep() {
  bool swept_before = false, is_failing = false;
  {
    MutexLock lock(mutex_);
    if (closing_ || sweep_is_damaged_ || Clock::now() < next_sweep_) return;
    swept_before = sweeping_;
    is_failing = failing_;
  }
  const absl::StatusOr<bool> swept = SweepStep(*writer_);
  const bool has_ended = swept.ok() && !*swept;
  if (is_failing && swept.ok() && *swept && reserve_.held()) reserve_.Release();
  // The file gets shorter when the log is written back. A full disk has no room for a longer log.
  if (is_failing || !swept.ok() || (swept_before && has_ended)) WriteLogBack();
  if (has_ended && !is_failing && !reserve_.held() && next_reserve_ <= Clock::now()) {
    reserve_.Take();
    next_reserve_ = Clock::now() + kBetweenReserves;
  }
  NoteSweep(swept);
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
  swept_ = swept.ok() && !*swept;
  sweeping_ = swept.ok() ? *swept : sweeping_;
  sweep_advances_ = swept.ok() && *swept;
  sweep_is_damaged_ = is_damage;
  next_sweep_ = swept.ok() ? Clock::now() : Clock::now() + options_.retry;
  written_.NotifyAll();
}

// ---- outcomes ----

void Store::Settle(Writes& batch, size_t first, size_t last, const absl::Status& status) {
  {
    MutexLock lock(mutex_);
    in_batch_ -= last - first;
    swept_ = false;
    for (size_t i = first; i < last; ++i) bytes_ -= batch[i].bytes;
    written_.NotifyAll();
  }
  for (size_t i = first; i < last; ++i) {
    Write& write = batch[i];
    write.settled = true;
    if (write.done) write.done(write.outcome.value_or(status));
    write.change = nullptr;  // releases its data; other groups of the batch may take long
    write.done = nullptr;
  }
}

void Store::SettleRest(Writes batch, const absl::Status& status) {
  Writes again;
  for (size_t i = 0; i < batch.size(); ++i) {
    Write& write = batch[i];
    const bool waits = !write.outcome && write.lasting && !write.superseded;
    if (write.settled) continue;
    if (waits) {
      again.push_back(std::move(write));
    } else {
      Settle(batch, i, i + 1, status);
    }
  }
  Requeue(std::move(again));
}

void Store::Requeue(Writes again) {
  MutexLock lock(mutex_);
  in_batch_ = 0;
  const bool dropped = closing_ || stop_waiting_;
  for (const Write& write : again) {
    if (dropped) bytes_ -= write.bytes;
    if (!dropped && write.urgent) ++urgent_;
  }
  if (!dropped) {
    pending_.insert(pending_.begin(), std::make_move_iterator(again.begin()),
                    std::make_move_iterator(again.end()));
  }
  written_.NotifyAll();
}

// Logs a failure once, and again only if the failure changes.
void Store::NoteHealth(const absl::Status& status) {
  MutexLock lock(mutex_);
  if (!status.ok()) {
    ++failures_;
    retry_time_ = Clock::now() + options_.retry;
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
