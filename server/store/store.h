// The server's persistent store: one SQLite file in WAL mode with synchronous=FULL.
//
// One thread owns the only connection that writes and that copies the log back into the file. It
// commits writes in groups (a commit flushes the disk, which takes some 4 ms; a row in a group
// takes 0.1 ms). Reads use read-only connections, several at a time, and see committed data.
// Thread-safe.
//
// There are two kinds of writes. A request (`Commit`) is committed at once and fails if the disk
// fails. A record (`Record...`) is a computed result: it may wait `delay` for others, and if the
// disk fails, it is retried until it succeeds or the store is closed. Writes are committed in the
// order in which they were posted; while the disk fails, requests do not wait for records, which
// wait for the next retry. A point's checkpoint is skipped if a later checkpoint or the result of
// the point waits too. The space of deleted jobs is freed a little at a time, by requests of the
// store itself (sweeper.h).
//
// When the disk fails (IsOfTheDisk):
//   - A request that fails has no visible effect. But if it failed during the flush of the log, its
//     outcome is unknown until the next commit: its bytes may be on disk, and if the machine stops
//     before that commit, the request may have taken effect after the restart. So a retry must be
//     idempotent: by its request_id, or because the requested state already holds.
//   - Records wait. The store retries them every `retry`, in small groups; without records it tests
//     the disk. The bounds of AwaitRoom limit the memory of waiting records.
//   - If the disk is full, the store writes the log back into the file, so that the log's space can
//     be used again, and tries each request alone, because it may free space. A deletion that still
//     has no room gets that of the reserve, a file of zeros beside the store. Records wait until
//     the space is free.
// If the disk hangs (`stalled`), the store refuses new requests until the disk answers; earlier
// requests wait.
// A write that can never succeed (a violated constraint, too big) is refused alone, and the other
// writes of its group are committed.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/host.h"
#include "server/mutex.h"
#include "server/store/point_tables.h"
#include "server/store/reader_pool.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

class Store {
 public:
  // Runs in a transaction, and again if the transaction was rolled back. The change refuses by
  // Database::Fail with a status that is not a disk error; it is then rolled back.
  using Change = std::function<void(Database&)>;
  // Called on the store's thread when the record's own group is committed, or when the record is
  // refused; in the order of the commits. Must be quick. It is not called after a failure that is
  // retried.
  using Done = std::function<void(const absl::Status&)>;

  struct Options {
    std::chrono::milliseconds delay{100};
    std::chrono::milliseconds retry{1000};  // after a failure of the disk
    std::chrono::milliseconds stall{5000};  // a group that takes longer: the disk hangs
    int readers = 4;                        // read-only connections
    size_t max_pending = 10'000;            // AwaitRoom waits above it,
    size_t max_pending_bytes = 64 << 20;    // and above this
    // Disk space for deletions. It is larger than the part of the log that may not fit into the
    // file.
    size_t reserve_bytes = 16 << 20;
  };

  // Errors as OpenStoreFile.
  static absl::StatusOr<std::unique_ptr<Store>> Open(const std::string& path, Options options);
  ~Store();  // closes

  // Returns when the change is on disk: OK and what the change has returned, or the error. If the
  // disk hangs, returns UNAVAILABLE at once and does not run the change.
  template <typename Function>
  auto Commit(Function change) {
    return Committed(change, false);
  }
  // As Commit, for a change that frees space.
  template <typename Function>
  auto CommitDeletion(Function change) {
    return Committed(change, true);
  }

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

  // Returns what `read` returns, or an error. As ReaderPool::Read.
  template <typename Function>
  auto Read(Function read) {
    return Returned(read, [&](const Change& run) { return readers_.Read(run); });
  }

  // Waits until few enough writes are pending, or the store is closing. Returns the seconds of the
  // wait.
  double AwaitRoom();

  // Waits for Options::retry, or until StopWaiting or Close. For a read that the disk failed.
  void AwaitRetry();

  // When this returns OK, all records posted before the call are on disk. Returns UNAVAILABLE if
  // the disk fails or hangs.
  absl::Status Flush();

  // Returns when the space of all deletions so far is free. False: because of StopWaiting or Close.
  bool AwaitSwept();

  // The last write failed because of the disk.
  bool failing() const;

  // The store's thread has been at one group for longer than Options::stall: the disk hangs.
  bool stalled() const;

  // For a shutdown: AwaitRoom, AwaitRetry and AwaitSwept no longer wait.
  void StopWaiting();

  // Writes what is pending, without a retry, and ends the thread. Later writes fail.
  void Close();

  // The random name that the store got when it was made.
  const std::string& identity() const { return identity_; }

  struct Counts {
    int64_t commits = 0;
    int64_t checkpoints_written = 0;
    int64_t pending_writes = 0;  // now
  };
  Counts counts() const;

 private:
  using Clock = std::chrono::steady_clock;

  static constexpr Clock::time_point kNever = Clock::time_point::max();

  enum class Kind { kRecord, kCheckpoint, kRequest, kDeletion };

  struct Write {
    Kind kind = Kind::kRecord;
    Change change = {};
    Done done = {};
    size_t bytes = 0;            // of memory, approximately
    int64_t job = 0, point = 0;  // of a checkpoint or a result
    bool has_waited = false;     // because the disk failed
    // Set when the write is refused, or when a request has failed.
    std::optional<absl::Status> outcome = {};

    bool IsRequest() const { return kind >= Kind::kRequest; }
  };
  using Writes = std::list<Write>;

  // Lets `run` call `function`, and returns what the function has returned if the status is OK.
  template <typename Function, typename Run>
  static auto Returned(Function& function, Run run) {
    using Result = std::invoke_result_t<Function&, Database&>;
    if constexpr (std::is_void_v<Result>) {
      return absl::Status(run([&](Database& database) { function(database); }));
    } else {
      std::optional<Result> result;
      const absl::Status status = run([&](Database& database) { result = function(database); });
      return status.ok() ? absl::StatusOr<Result>(*std::move(result)) : status;
    }
  }

  template <typename Function>
  auto Committed(Function& change, bool frees_space) {
    return Returned(change, [&](Change run) {
      return CommitRequest(frees_space ? Kind::kDeletion : Kind::kRequest, std::move(run));
    });
  }

  Store(std::unique_ptr<Database> writer, Options options, const std::string& path,
        std::string identity);
  void Start();

  void Post(Write write, bool soon = false) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status CommitRequest(Kind kind, Change change);
  // How long this write may wait for others. All writes that wait are committed together with it.
  Clock::duration DelayOf(const Write& write) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Whether more than one `part`-th of the room of AwaitRoom is taken.
  bool IsFull(size_t part = 1) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  // ---- the store's thread (store_thread.cc) ----

  void WriteUntilClosed();
  bool AwaitWork();  // false: closed, and nothing is left to write
  bool AllAreDue(Clock::time_point now) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool SweepIsDue(Clock::time_point now) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool GroupIsDue(Clock::time_point now) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void DropSuperseded() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The first writes that wait, or only requests if the records are not due; and a step of the
  // sweeper if it is due. Empty: only test the disk.
  Writes TakeGroup() ABSL_LOCKS_EXCLUDED(mutex_);
  Write SweepStepWrite();
  void WriteGroup(Writes group);
  // Commits all or none of the writes, except those that are refused. Not OK: the disk failed.
  absl::Status CommitGroup(Writes::iterator first, Writes::iterator last);
  void BeginGroup();
  // Sets the outcome of a write that can never succeed. False: the group has to begin again,
  // without this write.
  bool Run(Write& write);
  // Sets the outcomes of the requests of a group that failed. Its records wait again.
  void SettleFailed(Writes& group, const absl::Status& failure);
  void PutBack(Writes& group) ABSL_LOCKS_EXCLUDED(mutex_);
  // On a full disk the request is tried alone, because it may free space.
  void CommitAlone(Writes::iterator request, const absl::Status& failure);
  void WriteLogBack();
  // Errors are not reported: without the reserve a deletion on a full disk may fail.
  void TakeReserve();  // writes the file, if there is room
  void ReleaseReserve();
  void NoteSweep(const absl::Status& status, bool has_advanced) ABSL_LOCKS_EXCLUDED(mutex_);

  void Settle(const Writes& group) ABSL_LOCKS_EXCLUDED(mutex_);  // tells the outcomes
  void NoteHealth(const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_);

  const Options options_;
  const std::string identity_;
  const std::string reserve_path_;
  // Only the store's thread uses these two.
  std::unique_ptr<Database> writer_;
  bool holds_reserve_ = false;
  std::atomic<Clock::rep> busy_since_ = 0;  // the start of its present group; 0: it waits

  ReaderPool readers_;

  mutable Mutex mutex_;
  Condition posted_;
  Condition written_;
  Writes waiting_ ABSL_GUARDED_BY(mutex_);       // in the order of posting
  size_t requests_ ABSL_GUARDED_BY(mutex_) = 0;  // those in waiting_
  size_t in_group_ ABSL_GUARDED_BY(mutex_) = 0;  // writes that are being committed
  size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;     // of waiting_ and the group
  // When all waiting writes are to be committed; while the disk fails, the time of the next
  // attempt.
  Clock::time_point due_ ABSL_GUARDED_BY(mutex_) = kNever;
  bool failing_ ABSL_GUARDED_BY(mutex_) = false;
  std::string failure_ ABSL_GUARDED_BY(mutex_);  // the last failure that was logged
  bool stop_waiting_ ABSL_GUARDED_BY(mutex_) = false;
  bool closing_ ABSL_GUARDED_BY(mutex_) = false;
  Counts counts_ ABSL_GUARDED_BY(mutex_);  // without the pending writes
  // When to free space next; kNever: there is no space to free.
  Clock::time_point next_sweep_ ABSL_GUARDED_BY(mutex_) = kNever;
  bool sweep_advances_ ABSL_GUARDED_BY(mutex_) = false;  // the last step has freed some
  Thread thread_;
};

}  // namespace ballpiston::server
