#include "server/store/store.h"

#include <algorithm>
#include <utility>

#include "server/status/failpoint.h"
#include "server/store/schema.h"
#include "server/store/sweeper.h"

namespace ballpiston::server {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks(100);  // whether the disk hangs

absl::Status Stalled() {
  return absl::UnavailableError("store: the disk does not answer; retry later");
}

std::string ReserveOf(const std::string& path) { return path + "-reserve"; }

absl::Status Closed() { return absl::UnavailableError("store: closed"); }

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> Store::Open(const std::string& path, Options options) {
  auto writer = OpenStoreFile(path);
  if (IsOfTheDisk(writer.status())) {  // a full disk has the room of the last server's reserve
    Database::RemoveFile(ReserveOf(path));
    writer = OpenStoreFile(path);
  }
  if (!writer.ok()) return writer.status();
  auto identity = (*writer)->First<std::string>("SELECT identity FROM server");
  if (!(*writer)->status().ok()) return (*writer)->TakeStatus();
  auto store =
      std::unique_ptr<Store>(new Store(*std::move(writer), options, path, identity.value_or("")));
  for (int i = 0; i < store->options_.readers; ++i) {
    const absl::Status added = store->readers_.Add(path);
    if (!added.ok()) return added;
  }
  store->Start();
  return store;
}

Store::Store(std::unique_ptr<Database> writer, Options options, const std::string& path,
             std::string identity)
    : options_(options),
      identity_(std::move(identity)),
      reserve_path_(ReserveOf(path)),
      writer_(std::move(writer)) {}

void Store::Start() {
  TakeReserve();
  {
    MutexLock lock(mutex_);
    if (IsSweeping(*writer_)) next_sweep_ = SteadyNow();  // goes on where the last process stopped
  }
  thread_ = Thread([this] { WriteUntilClosed(); });
}

Store::~Store() { Close(); }

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

// ---- posting ----

absl::Status Store::CommitRequest(Kind kind, Change change) {
  if (stalled()) return Stalled();
  std::optional<absl::Status> outcome;
  const auto done = [&](const absl::Status& status) {
    MutexLock lock(mutex_);
    outcome = status;  // before written_ is notified
  };
  Post({.kind = kind, .change = std::move(change), .done = done});
  MutexLock lock(mutex_);
  while (!outcome) written_.Wait(mutex_);
  return *outcome;
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
    WriteCheckpoint(database, job, point, static_cast<int64_t>(chunk), serialize());
  };
  Post({.kind = Kind::kCheckpoint,
        .change = std::move(change),
        .bytes = bytes,
        .job = job,
        .point = point});
}

void Store::RecordChunk(int64_t job, int64_t point, uint64_t chunk, std::string record) {
  const size_t bytes = record.size();
  auto change = [=, record = std::move(record)](Database& database) {
    InsertChunk(database, job, point, static_cast<int64_t>(chunk), record);
  };
  Post({.change = std::move(change), .bytes = bytes});
}

void Store::RecordResult(int64_t job, PointRow row, std::function<void(int64_t number)> stored) {
  const auto number = std::make_shared<int64_t>(0);
  Write write = {.bytes = row.bytes(), .job = job, .point = row.point};
  write.change = [job, row = std::move(row), number](Database& database) {
    *number = InsertResult(database, job, row);
  };
  write.done = [number, stored = std::move(stored)](const absl::Status& status) {
    if (status.ok() && stored && *number > 0) stored(*number);
  };
  Post(std::move(write));
}

void Store::Post(Write write, bool soon) {
  {
    MutexLock lock(mutex_);
    if (!closing_) {
      waiting_.push_back(std::move(write));  // first: without memory it throws
      const Write& added = waiting_.back();
      requests_ += added.IsRequest() ? 1 : 0;
      bytes_ += added.bytes;
      const Clock::duration delay = soon ? Clock::duration::zero() : DelayOf(added);
      const Clock::time_point due = std::min(due_, SteadyNow() + delay);
      // The store's thread knows already when the other writes are due.
      if (std::exchange(due_, due) != due || added.IsRequest()) posted_.NotifyOne();
      return;
    }
  }
  if (write.done) write.done(Closed());
}

// Records share the group of a request. They are also due when half of the room is taken, because
// AwaitRoom must not wait for the delay. While the disk fails, requests are due by themselves.
Store::Clock::duration Store::DelayOf(const Write& write) const {
  if (failing_) return options_.retry;
  if (write.IsRequest() || IsFull(2)) return Clock::duration::zero();
  return options_.delay;
}

// ---- waiting ----

absl::Status Store::Flush() {
  // Shared, because this function does not wait for a hanging disk.
  const auto outcome = std::make_shared<std::optional<absl::Status>>();
  const auto done = [this, outcome](const absl::Status& status) {
    MutexLock lock(mutex_);
    *outcome = failing_ ? absl::UnavailableError(failure_) : status;
  };
  Post({.kind = Kind::kRequest, .change = [](Database&) {}, .done = done}, true);
  MutexLock lock(mutex_);
  while (!*outcome) {
    if (stalled()) return Stalled();
    written_.WaitUntil(mutex_, SteadyNow() + kBetweenLooks);
  }
  return **outcome;
}

bool Store::AwaitSwept() {
  MutexLock lock(mutex_);
  while (!stop_waiting_ && !closing_ && next_sweep_ != kNever) written_.Wait(mutex_);
  return !stop_waiting_ && !closing_;
}

bool Store::IsFull(size_t part) const {
  return waiting_.size() + in_group_ > options_.max_pending / part ||
         bytes_ > options_.max_pending_bytes / part;
}

double Store::AwaitRoom() {
  MutexLock lock(mutex_);
  if (!IsFull()) return 0;
  const Clock::time_point begin = SteadyNow();
  while (!stop_waiting_ && !closing_ && IsFull()) written_.Wait(mutex_);
  return std::chrono::duration<double>(SteadyNow() - begin).count();
}

void Store::AwaitRetry() {
  const Clock::time_point end = SteadyNow() + options_.retry;
  MutexLock lock(mutex_);
  while (!stop_waiting_ && !closing_ && SteadyNow() < end) written_.WaitUntil(mutex_, end);
}

void Store::StopWaiting() {
  MutexLock lock(mutex_);
  stop_waiting_ = true;
  written_.NotifyAll();
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
  counts.pending_writes = static_cast<int64_t>(waiting_.size() + in_group_);
  return counts;
}

}  // namespace ballpiston::server
