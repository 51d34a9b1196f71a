// The server's persistent store: one SQLite file in WAL mode with synchronous=FULL.
//
// One thread owns the only connection that writes and that copies the log back into the file. It
// commits writes in groups (a commit flushes the disk, which takes some 4 ms; a row in a group
// takes 0.1 ms). Order is kept: earlier writes are committed earlier or in the same group. Reads
// use read-only connections, several at a time, and see committed data. Thread-safe.
//
// There are two kinds of writes. A `Commit` is a client's request: it is committed at once and
// fails if the disk fails. A `Record` is a computed result: it may wait `delay` for others, and if
// the disk fails, it is retried until it succeeds or the store is closed. A point's checkpoint is
// skipped if the point has a later checkpoint or a result before it is written.
//
// When the disk fails (IsOfTheDisk):
//   - A request that fails has no visible effect. But if it failed during the flush of the log, its
//     outcome is unknown until the next commit: its bytes may be on disk, and if the machine stops
//     before that commit, the request may have taken effect after the restart. So a retry must be
//     idempotent: by its request_id, or because the requested state already holds.
//   - Records wait. The store retries them every `retry`; without records it tests the disk. The
//     bounds of AwaitRoom limit the memory of waiting records.
//   - If the disk is full, the store writes the log back into the file, so that the log's space can
//     be used again. It writes records in smaller and smaller groups. It tries requests alone and
//     before earlier records, because requests may free space. They succeed while the log has room.
//     The log has no room left when the file has no room for the log's contents either. Then a
//     request that frees space gets the room of a reserve (reserve.h), and records wait until the
//     space is free.
// If the disk hangs (`stalled`), the store refuses new requests until the disk answers; earlier
// requests wait.
// The space of deleted jobs is freed a little at a time, between other writes (sweeper.h).
// A write that can never succeed (a violated constraint, too big) is refused alone, and the other
// writes of its group are committed.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/mutex.h"
#include "server/store/point_tables.h"
#include "server/store/reserve.h"
#include "server/store/sqlite.h"
#include "server/store/sweeper.h"

namespace ballpiston::server {

class Store {
 public:
  // Runs in a transaction, and again if the transaction was rolled back, so each run must set all
  // its outputs. Not OK: SQLite failed, or the change refuses (with a status that is not a disk
  // error); the change is then rolled back, and `Done` receives the status.
  using Change = std::function<absl::Status(Database&)>;
  // Called on the store's thread when the write's own group is committed, or when the write is
  // refused; in the order of the commits. Must be quick. For a record it is not called after a
  // failure that is retried.
  using Done = std::function<void(const absl::Status&)>;

  struct Options {
    std::chrono::milliseconds delay{100};
    std::chrono::milliseconds retry{1000};  // after a failure of the disk
    std::chrono::milliseconds stall{5000};  // a disk call that takes longer: the disk hangs
    int readers = 4;                        // read-only connections
    size_t max_pending = 10'000;            // AwaitRoom waits above it,
    size_t max_pending_bytes = 64 << 20;    // and above this
    // Disk space for deletions. It is larger than the part of the log that may not fit into the
    // file.
    size_t reserve_bytes = 16 << 20;
    std::string vfs = {};  // of SQLite; empty: the operating system's
  };

  // Errors as OpenStoreFile.
  static absl::StatusOr<std::unique_ptr<Store>> Open(const std::string& path, Options options);
  ~Store();  // closes

  // Returns when the change is on disk, after `done`. If the disk hangs, returns UNAVAILABLE at
  // once and does not run the change.
  absl::Status Commit(Change change, Done done = nullptr);
  // As Commit, for a change that frees space.
  absl::Status CommitDeletion(Change change, Done done = nullptr);

  void Record(Change change, Done done = nullptr);
  // As Record, but without delay.
  void RecordSoon(Change change, Done done = nullptr);

  // `serialize` returns the checkpoint's record; the store calls it just before the write. `bytes`
  // is the approximate memory that `serialize` holds until then. The checkpoint contains all chunks
  // before `chunk`.
  void RecordCheckpoint(int64_t job, int64_t point, uint64_t chunk,
                        std::function<std::string()> serialize, size_t bytes = 0);
  void RecordChunk(int64_t job, int64_t point, uint64_t chunk, std::string record);
  // Calls `stored` like a Done when the result is on disk, with the result's number in the store.
  // Does not call it if the point already had a result.
  void RecordResult(int64_t job, PointRow row,
                    std::function<void(int64_t number)> stored = nullptr);

  // Runs `read` on one of the read-only connections, in a transaction: it sees the store at one
  // moment. Waits while all connections are in use.
  absl::Status Read(absl::FunctionRef<absl::Status(Database&)> read);

  // Returns when few enough writes are pending, or the store is closing.
  void AwaitRoom();

  // When this returns OK, all records posted before the call are on disk.
  absl::Status Flush();

  // For tests: returns when the space of all deletions so far is free.
  void AwaitSwept();

  // The last write failed because of the disk.
  bool failing() const;

  // A disk call has been in progress for longer than Options::stall: the disk hangs.
  bool stalled() const;

  // For a shutdown: AwaitRoom no longer waits, and failed writes are not retried.
  void StopWaiting();

  // Writes what is pending and ends the thread. Later writes fail.
  void Close();

  const std::string& path() const { return path_; }

  // The random name that the store got when it was made.
  const std::string& identity() const { return identity_; }

  int64_t commits() const;  // so far; for tests and metrics
  int64_t checkpoints_written() const;
  int64_t failures() const;        // groups of writes that failed because of the disk
  int64_t pending_writes() const;  // now

 private:
  using Clock = std::chrono::steady_clock;

  struct Write {
    Change change = {};
    Done done = {};
    bool urgent = false;
    bool lasting = true;   // retried after a failure
    bool ordered = false;  // a request that must follow all earlier writes
    bool frees_space = false;
    size_t bytes = 0;    // of memory, about
    int64_t job = 0;     // of a checkpoint or a result
    int64_t point = -1;  // of a checkpoint or a result
    bool is_result = false;
    bool superseded = false;  // a checkpoint with a later one, or with the point's result, after it
    bool settled = false;     // its outcome is told

    bool is_checkpoint() const { return point >= 0 && !is_result; }
    Clock::time_point due = {};
    // Committed or refused; empty if the disk failed before.
    std::optional<absl::Status> outcome = {};
  };
  using Writes = std::deque<Write>;

  struct Batch {
    Writes writes;      // empty: only test the disk
    bool whole = true;  // all pending writes, not only requests
  };

  Store(std::unique_ptr<Database> writer, std::vector<std::unique_ptr<Database>> readers,
        Options options, std::string path, std::string identity);

  std::unique_ptr<Database> TakeReader();  // null: closed
  void GiveBack(std::unique_ptr<Database> reader);
  void CloseReaders();

  void Post(Write write) ABSL_LOCKS_EXCLUDED(mutex_);
  bool IsFull() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status Await(Write write);
  void WriteUntilClosed();
  bool AwaitWork();  // false: closed, and nothing is left to write
  std::optional<Batch> TakeBatch();
  bool BatchIsDue(Clock::time_point now) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool SweepIsDue(Clock::time_point now) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::optional<Clock::time_point> NextDue() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Batch TakePending(bool whole) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Writes TakeRequests() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void MarkSuperseded(Writes& batch) const;

  // Commits the batch in groups and settles each group. The status is that of the last group; if it
  // is not OK, the disk failed.
  absl::Status CommitBatch(Batch& batch);
  absl::Status CommitRequestsAlone(Writes& batch, size_t first, const absl::Status& full);
  // Commits all or none of writes [first, last), except those that are refused.
  absl::Status CommitGroup(Writes& batch, size_t first, size_t last);
  absl::Status TryGroup(Writes& batch, size_t first, size_t last, std::optional<size_t>& culprit);
  absl::Status BeginGroup();
  absl::Status CommitRequest(Writes& batch, size_t request);
  static size_t GroupEnd(const Writes& batch, size_t first, size_t most);
  void WriteLogBack();
  void Sweep();
  void NoteSweep(const absl::StatusOr<bool>& swept) ABSL_LOCKS_EXCLUDED(mutex_);

  // Tells writes [first, last) their outcome; that of a write which is neither committed nor
  // refused is `status`.
  void Settle(Writes& batch, size_t first, size_t last, const absl::Status& status)
      ABSL_LOCKS_EXCLUDED(mutex_);
  // Settles what the disk did not take: requests fail, and records wait for the next try.
  void SettleRest(Writes batch, const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_);
  void Requeue(Writes again) ABSL_LOCKS_EXCLUDED(mutex_);
  void NoteHealth(const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_);

  const Options options_;
  const std::string path_;
  const std::string identity_;
  // Only the store's thread uses these five. Any thread may read from disk_calls_ how long a call
  // waits.
  std::unique_ptr<Database> writer_;
  const std::shared_ptr<DiskCalls> disk_calls_;
  Reserve reserve_;
  Clock::time_point next_reserve_;

  Mutex readers_mutex_;
  Condition reader_is_free_;
  std::vector<std::unique_ptr<Database>> free_readers_ ABSL_GUARDED_BY(readers_mutex_);
  size_t readers_ ABSL_GUARDED_BY(readers_mutex_) = 0;  // free or in use; 0: closed

  mutable Mutex mutex_;
  Condition posted_;
  Condition written_;
  Writes pending_ ABSL_GUARDED_BY(mutex_);
  size_t in_batch_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;     // of pending_ and of the batch
  size_t urgent_ ABSL_GUARDED_BY(mutex_) = 0;    // among pending_; all requests are urgent
  size_t requests_ ABSL_GUARDED_BY(mutex_) = 0;  // among pending_
  size_t ordered_ ABSL_GUARDED_BY(mutex_) = 0;   // among pending_
  bool failing_ ABSL_GUARDED_BY(mutex_) = false;
  std::string failure_ ABSL_GUARDED_BY(mutex_);  // the last failure that was logged
  Clock::time_point retry_time_ ABSL_GUARDED_BY(mutex_);
  bool stop_waiting_ ABSL_GUARDED_BY(mutex_) = false;
  bool closing_ ABSL_GUARDED_BY(mutex_) = false;
  int64_t commits_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t checkpoints_written_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t failures_ ABSL_GUARDED_BY(mutex_) = 0;
  bool swept_ ABSL_GUARDED_BY(mutex_) = false;             // nothing to free since the last batch
  bool sweeping_ ABSL_GUARDED_BY(mutex_) = false;          // the last step found something to do
  bool sweep_advances_ ABSL_GUARDED_BY(mutex_) = false;    // and has done it
  bool sweep_is_damaged_ ABSL_GUARDED_BY(mutex_) = false;  // until the next start
  Clock::time_point next_sweep_ ABSL_GUARDED_BY(mutex_);
  std::thread thread_;
};

}  // namespace ballpiston::server
