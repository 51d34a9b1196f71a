// The server's memory: one SQLite file in WAL mode with synchronous=FULL.
//
// One thread owns the only connection that writes and checkpoints, and commits writes in groups
// (a commit costs a flush of the disk, some 4 ms; a row in a group 0.1 ms). Order is kept: what was
// posted first is committed first or together. Reads go through a second, read-only connection and
// see what is committed. Thread-safe.
//
// Two kinds of writes. A `Commit` is somebody's request: it is committed at once and fails if the
// disk does. A `Record` is a computed result: it may wait `delay` for company, and if the disk
// fails it is tried again until it succeeds or the store is closed. A block whose point is finished
// by the time it would be written is not written at all.
#ifndef BALLPISTON_SERVER_STORE_STORE_H_
#define BALLPISTON_SERVER_STORE_STORE_H_

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/point_tables.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

class Store {
 public:
  // Runs in a transaction, perhaps more than once (if the transaction had to be rolled back), so it
  // sets what it returns by reference anew each time. Not OK: SQLite failed.
  using Change = std::function<absl::Status(Database&)>;
  // After the commit, on the store's thread, in the order of posting: has to be quick.
  using Done = std::function<void(const absl::Status&)>;

  struct Options {
    std::chrono::milliseconds delay{100};
    std::chrono::milliseconds retry{1000};  // after a failure of the disk
    size_t max_pending = 10'000;            // AwaitRoom waits above it
  };

  // Errors as OpenStoreFile.
  static absl::StatusOr<std::unique_ptr<Store>> Open(const std::string& path, Options options);
  ~Store();  // closes

  // Returns when it is on disk; `done`, if any, was called before.
  absl::Status Commit(Change change, Done done = nullptr);

  void Record(Change change, Done done = nullptr);
  // As Record, but without delay.
  void RecordSoon(Change change, Done done = nullptr);

  // `serialize` gives the block's record when it is about to be written.
  void RecordBlock(int64_t job, int64_t point, int64_t block,
                   std::function<std::string()> serialize);
  // `stored`, if any, is called as a Done is, with the result's number in the store: when it is on
  // disk, unless the point had a result.
  void RecordResult(int64_t job, PointRow row, std::function<void(int64_t number)> stored = nullptr);

  // Runs `read` on the read-only connection, one at a time.
  absl::Status Read(absl::FunctionRef<absl::Status(Database&)> read);

  // Returns when few enough writes are pending, or the store is closing.
  void AwaitRoom();

  // What was recorded before this call is on disk when it returns OK.
  absl::Status Flush();

  // AwaitRoom waits no longer, and a disk that fails is not tried again: for a shutdown.
  void StopWaiting();

  // Writes what is pending and ends the thread. Later writes fail.
  void Close();

  int64_t commits() const;  // so far; for tests and metrics
  int64_t blocks_written() const;
  int64_t pending_writes() const;  // now
  // The disk failed when something was last written, and has not worked since.
  bool failing() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Write {
    Change change;
    Done done;
    bool urgent = false;
    bool lasting = true;  // tried again after a failure
    int64_t job = 0;      // of a block or a result
    int64_t point = -1;   // of a block or a result
    bool is_result = false;
    bool superseded = false;  // a block whose point is finished
    Clock::time_point due;
  };

  Store(std::unique_ptr<Database> writer, std::unique_ptr<Database> reader, Options options);

  void Post(Write write);
  void WriteUntilClosed();
  std::deque<Write> AwaitBatch();
  bool BatchIsDue(Clock::time_point now) const;
  void MarkSuperseded(std::deque<Write>& batch) const;
  absl::Status CommitBatch(std::deque<Write>& batch);
  void Settle(std::deque<Write> batch, const absl::Status& status);
  void Requeue(std::deque<Write> batch);

  const Options options_;
  std::unique_ptr<Database> writer_;  // of the thread

  std::mutex reader_mutex_;
  std::unique_ptr<Database> reader_;

  mutable std::mutex mutex_;
  std::condition_variable posted_;
  std::condition_variable written_;
  std::deque<Write> pending_;
  size_t in_batch_ = 0;
  size_t urgent_ = 0;  // among pending_
  bool failing_ = false;
  bool stop_waiting_ = false;
  bool closing_ = false;
  int64_t commits_ = 0;
  int64_t blocks_written_ = 0;
  std::thread thread_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_STORE_H_
