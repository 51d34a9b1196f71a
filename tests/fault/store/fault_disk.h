// A disk for SQLite. It logs all operations, and rejects those that the test selects.
//
// While it lives, it is SQLite's file system for every connection that is opened. If there are
// several disks, SQLite uses the newest one. The files are in a temporary folder. SQLite's own file
// system for Unix reads and writes them, and has the locks and the log's index. Nothing is flushed:
// a sync is only logged. The name of a log or journal is flushed with its first sync.
//
// Every write, truncation, sync, creation and deletion is one operation, numbered from 0;
// power_cut.h says what a cut at any of them would leave. Thread-safe.
#pragma once

#include "absl/functional/function_ref.h"
#include "tests/support/preamble.h"

struct sqlite3_vfs;

namespace ballpiston::server {

// Where tests keep a store on such a disk.
inline constexpr char kStorePath[] = "/store.sqlite3";

// Contents by path.
using DiskFiles = std::map<std::string, std::string>;

struct DiskOperation {
  enum class Kind { kCreate, kDelete, kWrite, kTruncate, kSync };

  Kind kind = Kind::kWrite;
  std::string path = {};
  int file = 0;           // number of what the path names, never used again
  int64_t offset = 0;     // of a write; the new size of a truncation
  std::string data = {};  // of a write
  bool folder = false;    // of a sync or a deletion: the folder is flushed, too
  bool refused = false;   // nothing was done
};

class FaultDisk {
 public:
  enum class Refusal { kFull, kWriteError, kSyncError };

  explicit FaultDisk(DiskFiles files = {});
  ~FaultDisk();  // no connection may be left

  FaultDisk(const FaultDisk&) = delete;
  FaultDisk& operator=(const FaultDisk&) = delete;

  // Refuses operations of that kind (a full disk and a write error: writes; a sync error: syncs)
  // among the next `count` ones.
  void Refuse(Refusal refusal, size_t count = std::numeric_limits<size_t>::max() / 2);
  // Called before each operation of a file, which waits until `call` returns.
  void SetBeforeOperation(std::function<void()> call) { before_operation_ = std::move(call); }
  // Limits the total size of all files.
  void SetCapacity(int64_t bytes);
  void StopRefusing();

  int64_t refusals() const { return refusals_; }  // so far
  std::vector<DiskOperation> operations() const;
  int64_t bytes_used() const;
  DiskFiles initial() const { return initial_; }

  friend struct Methods;  // what SQLite calls

 private:
  std::string RealPath(const std::string& path) const { return folder_.path() + path; }

  // Logs the operation. Calls `perform` unless the operation is refused. The result and that of
  // `perform` are codes of SQLite.
  int Perform(DiskOperation operation, absl::FunctionRef<int()> perform);

  // The lock is held by the callers of these.
  int ErrorOf(const DiskOperation& operation) const;  // a code of SQLite
  bool OutgrowsCapacity(const DiskOperation& operation) const;
  int64_t BytesOf(const std::string& path) const;

  const TemporaryFolder folder_;
  const std::string name_;  // of the file system
  const DiskFiles initial_;
  std::unique_ptr<sqlite3_vfs> registered_;
  std::function<void()> before_operation_;

  mutable std::recursive_mutex mutex_;
  std::map<std::string, int> numbers_;  // of the files, by path
  int next_file_ = 0;
  std::vector<DiskOperation> operations_;
  std::optional<Refusal> refusal_;
  size_t end_of_refusal_ = 0;  // operations from this number on are not refused
  int64_t capacity_ = std::numeric_limits<int64_t>::max();
  std::atomic<int64_t> refusals_ = 0;
};

}  // namespace ballpiston::server
