#include "server/store/store.h"

#include <future>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/observability/failpoint.h"
#include "server/observability/log.h"
#include "server/store/schema.h"

namespace ballpiston::server {
namespace {

absl::Status Closed() { return absl::UnavailableError("store: closed"); }

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> Store::Open(const std::string& path, Options options) {
  auto writer = OpenStoreFile(path);
  if (!writer.ok()) return writer.status();
  auto reader = Database::Open(path, Database::Mode::kReadOnly);
  if (!reader.ok()) return reader.status();
  return std::unique_ptr<Store>(
      new Store(*std::move(writer), *std::move(reader), std::move(options)));
}

Store::Store(std::unique_ptr<Database> writer, std::unique_ptr<Database> reader, Options options)
    : options_(options),
      writer_(std::move(writer)),
      reader_(std::move(reader)),
      thread_([this] { WriteUntilClosed(); }) {}

Store::~Store() { Close(); }

absl::Status Store::Commit(Change change, Done done) {
  // Shared: the store's thread may still be leaving set_value when this one returns.
  auto committed = std::make_shared<std::promise<absl::Status>>();
  std::future<absl::Status> result = committed->get_future();
  Write write;
  write.change = std::move(change);
  write.urgent = true;
  write.lasting = false;
  write.done = [committed, done = std::move(done)](const absl::Status& status) {
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

void Store::RecordBlock(int64_t job, int64_t point, int64_t block,
                        std::function<std::string()> serialize) {
  Write write;
  write.job = job;
  write.point = point;
  write.change = [=, serialize = std::move(serialize)](Database& database) {
    Failpoint("block.before_insert");
    return InsertBlock(database, job, point, block, serialize());
  };
  Post(std::move(write));
}

void Store::RecordResult(int64_t job, PointRow row, std::function<void(int64_t number)> stored) {
  const auto number = std::make_shared<int64_t>(0);
  Write write;
  write.job = job;
  write.point = row.point;
  write.is_result = true;
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
    std::lock_guard lock(mutex_);
    if (!closing_) {
      urgent_ += write.urgent ? 1 : 0;
      pending_.push_back(std::move(write));
      posted_.notify_one();
      return;
    }
  }
  if (write.done) write.done(Closed());
}

absl::Status Store::Read(absl::FunctionRef<absl::Status(Database&)> read) {
  std::lock_guard lock(reader_mutex_);
  if (reader_ == nullptr) return Closed();
  return read(*reader_);
}

void Store::AwaitRoom() {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [this] {
    return stop_waiting_ || closing_ || pending_.size() + in_batch_ <= options_.max_pending;
  });
}

absl::Status Store::Flush() {
  return Commit([](Database&) { return absl::OkStatus(); });
}

void Store::StopWaiting() {
  std::lock_guard lock(mutex_);
  stop_waiting_ = true;
  posted_.notify_all();
  written_.notify_all();
}

void Store::Close() {
  {
    std::lock_guard lock(mutex_);
    closing_ = true;
    posted_.notify_all();
    written_.notify_all();
  }
  if (!thread_.joinable()) return;
  thread_.join();
  {
    std::lock_guard lock(reader_mutex_);
    reader_.reset();
  }
  Failpoint("stop.before_checkpoint");
  writer_.reset();  // last: the last connection to close checkpoints
}

int64_t Store::commits() const {
  std::lock_guard lock(mutex_);
  return commits_;
}

int64_t Store::blocks_written() const {
  std::lock_guard lock(mutex_);
  return blocks_written_;
}

int64_t Store::pending_writes() const {
  std::lock_guard lock(mutex_);
  return static_cast<int64_t>(pending_.size() + in_batch_);
}

bool Store::failing() const {
  std::lock_guard lock(mutex_);
  return failing_;
}

void Store::WriteUntilClosed() {
  while (true) {
    std::deque<Write> batch = AwaitBatch();
    if (batch.empty()) return;
    MarkSuperseded(batch);
    const absl::Status status = CommitBatch(batch);
    Settle(std::move(batch), status);
  }
}

bool Store::BatchIsDue(Clock::time_point now) const {
  if (closing_) return true;
  if (pending_.empty()) return false;
  return urgent_ > 0 || pending_.front().due <= now;
}

// Empty only when the store is closed and nothing is left to write.
std::deque<Store::Write> Store::AwaitBatch() {
  std::unique_lock lock(mutex_);
  if (failing_ && urgent_ == 0) {
    posted_.wait_for(lock, options_.retry,
                     [this] { return closing_ || stop_waiting_ || urgent_ > 0; });
  }
  while (!BatchIsDue(Clock::now())) {
    if (pending_.empty()) {
      posted_.wait(lock);
    } else {
      posted_.wait_until(lock, pending_.front().due);
    }
  }
  urgent_ = 0;
  in_batch_ = pending_.size();
  return std::exchange(pending_, {});
}

void Store::MarkSuperseded(std::deque<Write>& batch) const {
  std::set<std::pair<int64_t, int64_t>> finished;
  for (const Write& write : batch) {
    if (write.is_result) finished.emplace(write.job, write.point);
  }
  for (Write& write : batch) {
    const bool is_block = write.point >= 0 && !write.is_result;
    write.superseded = is_block && finished.contains({write.job, write.point});
  }
}

absl::Status Store::CommitBatch(std::deque<Write>& batch) {
  absl::Status status = writer_->Execute("BEGIN IMMEDIATE");
  int64_t blocks = 0;
  for (Write& write : batch) {
    if (!status.ok()) break;
    if (write.superseded) continue;
    status = write.change(*writer_);
    blocks += write.point >= 0 && !write.is_result ? 1 : 0;
  }
  Failpoint("store.before_commit");
  if (status.ok()) status = writer_->Execute("COMMIT");
  Failpoint("store.after_commit");
  if (!status.ok()) {
    writer_->Execute("ROLLBACK").IgnoreError();  // SQLite may have done so already
    return status;
  }
  std::lock_guard lock(mutex_);
  ++commits_;
  blocks_written_ += blocks;
  return status;
}

void Store::Settle(std::deque<Write> batch, const absl::Status& status) {
  std::deque<Write> again;
  for (Write& write : batch) {
    if (!status.ok() && write.lasting) {
      again.push_back(std::move(write));
    } else if (write.done) {
      write.done(status);
    }
  }
  if (!status.ok()) LogError(status.message());
  Requeue(std::move(again));
}

void Store::Requeue(std::deque<Write> batch) {
  std::lock_guard lock(mutex_);
  in_batch_ = 0;
  failing_ = !batch.empty();
  if (!closing_ && !stop_waiting_) {
    for (Write& write : batch) write.urgent = false;  // the wait before the next attempt decides
    pending_.insert(pending_.begin(), std::make_move_iterator(batch.begin()),
                    std::make_move_iterator(batch.end()));
  }
  written_.notify_all();
}

}  // namespace ballpiston::server
