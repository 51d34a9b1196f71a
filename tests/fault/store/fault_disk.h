// A disk in memory for SQLite. It logs all operations, and rejects those that the test selects.
//
// While it lives, it is SQLite's file system for every connection that is opened. If there are
// several disks, SQLite uses the newest one. It behaves like SQLite's own file system for Unix:
//   - The name of a log or journal is flushed with its first sync.
//   - Bytes outside those written are never changed.
//   - An empty file counts as not existing.
//   - All connections of the process share the locks and the log's index.
//
// Every write, truncation, sync, creation and deletion is one operation, numbered from 0;
// power_cut.h says what a cut at any of them would leave. Thread-safe.
#pragma once

#include "tests/support/preamble.h"

struct sqlite3_vfs;

namespace ballpiston::server {

// Where tests keep a store on such a disk.
inline constexpr char kStorePath[] = "/data/store.sqlite3";

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
  // among those with numbers first, first + 1, ..., first + count - 1.
  void Refuse(Refusal refusal, size_t first, size_t count = std::numeric_limits<size_t>::max() / 2);
  // Called before each operation of a file, which waits until `call` returns.
  void SetBeforeOperation(std::function<void()> call) { before_operation_ = std::move(call); }
  // Limits the total size of all files.
  void SetCapacity(int64_t bytes);
  void StopRefusing();

  size_t operation_count() const;
  int64_t refusals() const;  // so far
  std::vector<DiskOperation> operations() const;
  int64_t bytes_used() const;
  DiskFiles initial() const { return initial_; }

  // What SQLite calls (fault_disk.cc); codes are SQLite's.
  struct OpenFile;
  int Open(const char* path, int flags, OpenFile& file);
  int Delete(const std::string& path, bool sync_folder);
  bool Exists(const std::string& path);

 private:
  friend struct OpenFile;

  static constexpr int kShmLocks = 8;

  struct Shm {
    std::vector<std::unique_ptr<std::vector<char>>> regions;
    std::array<int, kShmLocks> readers{};
    std::array<bool, kShmLocks> writer{};
    int users = 0;
  };

  struct File {
    int number = 0;
    std::string path;
    std::string contents;
    bool temporary = false;  // SQLite's own; not part of the log
    int shared = 0;          // locks
    const void* reserved = nullptr;
    const void* pending = nullptr;
    const void* exclusive = nullptr;
    Shm shm;
  };

  // The lock is held.
  int Perform(DiskOperation operation);
  bool Refuses(const DiskOperation& operation) const;
  int CodeOf(const DiskOperation& operation) const;
  bool OutgrowsCapacity(const DiskOperation& operation) const;
  int64_t BytesUsed() const;

  const std::string name_;
  const DiskFiles initial_;
  std::unique_ptr<sqlite3_vfs> registered_;
  std::function<void()> before_operation_;

  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<File>> files_;
  int next_file_ = 0;
  std::vector<DiskOperation> operations_;
  std::optional<Refusal> refusal_;
  size_t first_refused_ = 0;
  size_t refused_count_ = 0;
  int64_t capacity_ = std::numeric_limits<int64_t>::max();
  int64_t refusals_ = 0;
  uint64_t random_ = 1;

  friend struct Methods;
};

}  // namespace ballpiston::server
