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
//
// When the disk fails (IsOfTheDisk):
//   - A request that fails has no effect that anybody sees. But one that failed while the log was
//     flushed is in doubt until the next commit: its bytes may have reached the disk, and if the
//     machine stops before that commit it may be found done. So a repetition has to be recognised,
//     by its request_id or because what it asks for is so already.
//   - Records wait; every `retry` they are tried again, and if there are none, the disk is. What
//     comes from AwaitRoom's bounds is all the memory that they take.
//   - Of a full disk: the log is written back, so that its place on the disk can be used again;
//     records are written in ever smaller groups; requests, which may free room, are tried alone,
//     before records that were posted earlier. They succeed as long as the log has room for them,
//     which it has not when the file, too, has no room to take back what is in the log.
// When the disk neither works nor fails (`stalled`): requests are refused until it answers; those
// that came before it hung wait.
// A write that cannot succeed whatever the disk does (a broken constraint, too big) is refused
// alone, and the others of its group are written.
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
#include <optional>
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
  // sets what it returns by reference anew each time. Not OK: SQLite failed, or the change refuses
  // itself (with a status that is not of the disk): it is rolled back and told that status.
  using Change = std::function<absl::Status(Database&)>;
  // After the commit or the refusal, on the store's thread, in the order of posting: has to be
  // quick. A record is not told of failures after which it is tried again.
  using Done = std::function<void(const absl::Status&)>;

  struct Options {
    std::chrono::milliseconds delay{100};
    std::chrono::milliseconds retry{1000};  // after a failure of the disk
    std::chrono::milliseconds stall{5000};  // a commit that takes longer: the disk hangs
    size_t max_pending = 10'000;            // AwaitRoom waits above it,
    size_t max_pending_bytes = 64 << 20;    // and above this
    std::string vfs = {};                   // of SQLite; empty: the operating system's
  };

  // Errors as OpenStoreFile.
  static absl::StatusOr<std::unique_ptr<Store>> Open(const std::string& path, Options options);
  ~Store();  // closes

  // Returns when it is on disk; `done`, if any, was called before. UNAVAILABLE, at once: the disk
  // hangs; the change was not run.
  absl::Status Commit(Change change, Done done = nullptr);

  void Record(Change change, Done done = nullptr);
  // As Record, but without delay.
  void RecordSoon(Change change, Done done = nullptr);

  // `serialize` gives the block's record when it is about to be written; `bytes` is about what it
  // holds until then.
  void RecordBlock(int64_t job, int64_t point, int64_t block,
                   std::function<std::string()> serialize, size_t bytes = 0);
  // `stored`, if any, is called as a Done is, with the result's number in the store: when it is on
  // disk, unless the point had a result.
  void RecordResult(int64_t job, PointRow row,
                    std::function<void(int64_t number)> stored = nullptr);

  // Runs `read` on the read-only connection, one at a time.
  absl::Status Read(absl::FunctionRef<absl::Status(Database&)> read);

  // Returns when few enough writes are pending, or the store is closing.
  void AwaitRoom();

  // What was recorded before this call is on disk when it returns OK.
  absl::Status Flush();

  // The disk failed when something was last written, and has not worked since.
  bool failing() const;

  // A commit has been in progress for longer than Options::stall: the disk hangs.
  bool stalled() const;

  // AwaitRoom waits no longer, and a disk that fails is not tried again: for a shutdown.
  void StopWaiting();

  // Writes what is pending and ends the thread. Later writes fail.
  void Close();

  int64_t commits() const;  // so far; for tests and metrics
  int64_t blocks_written() const;
  int64_t failures() const;        // groups of writes that the disk did not take
  int64_t pending_writes() const;  // now

 private:
  using Clock = std::chrono::steady_clock;

  struct Write {
    Change change;
    Done done;
    bool urgent = false;
    bool lasting = true;   // tried again after a failure
    bool ordered = false;  // a request that has to come after what was posted before it
    size_t bytes = 0;      // of memory, about
    int64_t job = 0;       // of a block or a result
    int64_t point = -1;    // of a block or a result
    bool is_result = false;
    bool superseded = false;  // a block whose point is finished
    Clock::time_point due;
    // What became of it: committed, or refused. None: the disk failed before.
    std::optional<absl::Status> outcome = {};
  };
  using Writes = std::deque<Write>;

  struct Batch {
    Writes writes;      // none: the disk is to be tried
    bool whole = true;  // all that was pending, not only requests
  };

  Store(std::unique_ptr<Database> writer, std::unique_ptr<Database> reader, Options options);

  void Post(Write write);
  absl::Status Await(Change change, Done done, bool ordered);
  void WriteUntilClosed();
  std::optional<Batch> AwaitBatch();
  bool BatchIsDue(Clock::time_point now) const;
  Batch TakePending(bool retry);
  Writes TakeRequests();
  void MarkSuperseded(Writes& batch) const;

  // Sets the outcome of all that was committed or refused. Not OK: the disk failed before the end.
  absl::Status CommitBatch(Writes& batch);
  absl::Status CommitRequestsAlone(Writes& batch, size_t first, const absl::Status& full);
  // Of writes [first, last), all or none, save those that are refused.
  absl::Status CommitGroup(Writes& batch, size_t first, size_t last);
  absl::Status TryGroup(Writes& batch, size_t first, size_t last, std::optional<size_t>& culprit);
  absl::Status BeginGroup();
  void WriteLogBack();

  void Settle(Batch batch, const absl::Status& status);
  void Requeue(Writes again, size_t freed);
  void NoteHealth(const absl::Status& status);

  const Options options_;
  std::unique_ptr<Database> writer_;  // of the thread

  std::mutex reader_mutex_;
  std::unique_ptr<Database> reader_;

  mutable std::mutex mutex_;
  std::condition_variable posted_;
  std::condition_variable written_;
  Writes pending_;
  size_t in_batch_ = 0;
  std::optional<Clock::time_point> group_begin_;  // of one that is being written
  size_t bytes_ = 0;                              // of pending_ and of the batch
  size_t urgent_ = 0;                             // among pending_; requests are
  size_t requests_ = 0;                           // among pending_
  size_t ordered_ = 0;                            // among pending_
  bool failing_ = false;
  std::string failure_;  // the last one that was told
  Clock::time_point retry_time_;
  bool stop_waiting_ = false;
  bool closing_ = false;
  int64_t commits_ = 0;
  int64_t blocks_written_ = 0;
  int64_t failures_ = 0;
  std::thread thread_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_STORE_H_
