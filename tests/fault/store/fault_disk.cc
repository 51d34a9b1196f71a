#include "tests/fault/store/fault_disk.h"

#include <sqlite3.h>

namespace ballpiston::server {
namespace {

std::string UniqueName() {
  static std::atomic<int> made = 0;
  return "fault-disk-" + std::to_string(++made);
}

void MakeFolderOf(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
}

// SQLite's file system for Unix.
sqlite3_vfs* System() { return sqlite3_vfs_find("unix"); }

// What SQLite allocates and passes back; the file of SQLite's own file system follows it in memory.
struct OpenFile {
  sqlite3_file base;  // has to be first
  FaultDisk* disk;
  std::string* path;  // owned; null: a temporary file of SQLite's, which is not part of the log
  int number;
  bool sync_folder;  // with the next sync

  sqlite3_file* system() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

OpenFile& Of(sqlite3_file* file) { return *reinterpret_cast<OpenFile*>(file); }
FaultDisk& Of(sqlite3_vfs* vfs) { return *static_cast<FaultDisk*>(vfs->pAppData); }

// Passes a method on to SQLite's own file.
template <auto kMethod>
struct PassOn;
template <typename Result, typename... Arguments,
          Result (*sqlite3_io_methods::*kMethod)(sqlite3_file*, Arguments...)>
struct PassOn<kMethod> {
  static Result Call(sqlite3_file* file, Arguments... arguments) {
    sqlite3_file* const system = Of(file).system();
    return (system->pMethods->*kMethod)(system, arguments...);
  }
};

}  // namespace

struct Methods {
  using Kind = DiskOperation::Kind;
  using Io = sqlite3_io_methods;

  // ---- files ----

  static int Close(sqlite3_file* file) {
    delete std::exchange(Of(file).path, nullptr);
    return PassOn<&Io::xClose>::Call(file);
  }

  static int Perform(sqlite3_file* file, DiskOperation operation,
                     absl::FunctionRef<int()> perform) {
    OpenFile& open = Of(file);
    if (open.path == nullptr) return perform();
    operation.path = *open.path;
    operation.file = open.number;
    if (open.disk->before_operation_) open.disk->before_operation_();
    return open.disk->Perform(std::move(operation), perform);
  }

  static int Write(sqlite3_file* file, const void* from, int bytes, sqlite3_int64 offset) {
    const std::string data(static_cast<const char*>(from), static_cast<size_t>(bytes));
    return Perform(file, {.offset = offset, .data = data},
                   [&] { return PassOn<&Io::xWrite>::Call(file, from, bytes, offset); });
  }

  static int Truncate(sqlite3_file* file, sqlite3_int64 size) {
    return Perform(file, {.kind = Kind::kTruncate, .offset = size},
                   [&] { return PassOn<&Io::xTruncate>::Call(file, size); });
  }

  static int Sync(sqlite3_file* file, int) {
    return Perform(file, {.kind = Kind::kSync, .folder = Of(file).sync_folder}, [&] {
      Of(file).sync_folder = false;
      return SQLITE_OK;
    });
  }

  static int FileControl(sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; }

  // ---- the file system ----

  static int Open(sqlite3_vfs* vfs, const char* path, sqlite3_file* file, int flags,
                  int* flags_out) {
    FaultDisk& disk = Of(vfs);
    OpenFile& open = Of(file);
    open = {.base = {}, .disk = &disk, .path = nullptr, .number = 0, .sync_folder = false};
    const bool may_create = (flags & SQLITE_OPEN_CREATE) != 0;
    if (path != nullptr) {
      const std::string name = NameOf(disk, path);
      std::lock_guard lock(disk.mutex_);
      const bool is_new = !disk.numbers_.contains(name);
      if (is_new && !may_create) return SQLITE_CANTOPEN;
      if (is_new) disk.numbers_[name] = disk.next_file_++;
      open.number = disk.numbers_.at(name);
      if (is_new) {
        MakeFolderOf(disk.RealPath(name));
        disk.Perform({.kind = Kind::kCreate, .path = name, .file = open.number},
                     [] { return SQLITE_OK; });
      }
      constexpr int kLogs = SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL | SQLITE_OPEN_WAL;
      open.sync_folder = may_create && (flags & kLogs) != 0;
      open.path = new std::string(name);
    }
    const int code = System()->xOpen(System(), path, open.system(), flags, flags_out);
    if (code == SQLITE_OK) open.base.pMethods = &kFile;
    if (code != SQLITE_OK) delete std::exchange(open.path, nullptr);
    return code;
  }

  static int Delete(sqlite3_vfs* vfs, const char* path, int sync_folder) {
    FaultDisk& disk = Of(vfs);
    const std::string name = NameOf(disk, path);
    std::lock_guard lock(disk.mutex_);
    const auto found = disk.numbers_.extract(name);
    if (found.empty()) return SQLITE_IOERR_DELETE_NOENT;
    return disk.Perform(
        {.kind = Kind::kDelete, .path = name, .file = found.mapped(), .folder = sync_folder != 0},
        [&] { return System()->xDelete(System(), disk.RealPath(name).c_str(), 0); });
  }

  static int Access(sqlite3_vfs* vfs, const char* path, int flags, int* found) {
    const FaultDisk& disk = Of(vfs);
    const std::string real = disk.RealPath(NameOf(disk, path));
    return System()->xAccess(System(), real.c_str(), flags, found);
  }

  static int FullPathname(sqlite3_vfs* vfs, const char* path, int bytes, char* full) {
    const FaultDisk& disk = Of(vfs);
    sqlite3_snprintf(bytes, full, "%s", disk.RealPath(NameOf(disk, path)).c_str());
    return SQLITE_OK;
  }

  // SQLite passes the full path, the server's code the name on the disk.
  static std::string NameOf(const FaultDisk& disk, const std::string& path) {
    const std::string& folder = disk.folder_.path();
    return path.starts_with(folder) ? path.substr(folder.size()) : path;
  }

  static constexpr Io kFile = {.iVersion = 2,
                               .xClose = Close,
                               .xRead = PassOn<&Io::xRead>::Call,
                               .xWrite = Write,
                               .xTruncate = Truncate,
                               .xSync = Sync,
                               .xFileSize = PassOn<&Io::xFileSize>::Call,
                               .xLock = PassOn<&Io::xLock>::Call,
                               .xUnlock = PassOn<&Io::xUnlock>::Call,
                               .xCheckReservedLock = PassOn<&Io::xCheckReservedLock>::Call,
                               .xFileControl = FileControl,
                               .xSectorSize = PassOn<&Io::xSectorSize>::Call,
                               .xDeviceCharacteristics = PassOn<&Io::xDeviceCharacteristics>::Call,
                               .xShmMap = PassOn<&Io::xShmMap>::Call,
                               .xShmLock = PassOn<&Io::xShmLock>::Call,
                               .xShmBarrier = PassOn<&Io::xShmBarrier>::Call,
                               .xShmUnmap = PassOn<&Io::xShmUnmap>::Call,
                               .xFetch = nullptr,
                               .xUnfetch = nullptr};
};

FaultDisk::FaultDisk(DiskFiles files) : name_(UniqueName()), initial_(std::move(files)) {
  for (const auto& [path, contents] : initial_) {
    numbers_[path] = next_file_++;
    MakeFolderOf(RealPath(path));
    WriteFile(RealPath(path), contents);
  }
  registered_ = std::make_unique<sqlite3_vfs>(*System());
  registered_->szOsFile += static_cast<int>(sizeof(OpenFile));
  registered_->zName = name_.c_str();
  registered_->pAppData = this;
  registered_->xOpen = Methods::Open;
  registered_->xDelete = Methods::Delete;
  registered_->xAccess = Methods::Access;
  registered_->xFullPathname = Methods::FullPathname;
  sqlite3_vfs_register(registered_.get(), 1);
}

FaultDisk::~FaultDisk() { sqlite3_vfs_unregister(registered_.get()); }

int FaultDisk::ErrorOf(const DiskOperation& operation) const {
  const bool is_write = operation.kind == DiskOperation::Kind::kWrite;
  if (is_write && OutgrowsCapacity(operation)) return SQLITE_FULL;
  if (!refusal_ || operations_.size() >= end_of_refusal_) return SQLITE_OK;
  if (is_write && *refusal_ == Refusal::kFull) return SQLITE_FULL;
  if (is_write && *refusal_ == Refusal::kWriteError) return SQLITE_IOERR_WRITE;
  const bool is_sync = operation.kind == DiskOperation::Kind::kSync;
  return is_sync && *refusal_ == Refusal::kSyncError ? SQLITE_IOERR_FSYNC : SQLITE_OK;
}

bool FaultDisk::OutgrowsCapacity(const DiskOperation& operation) const {
  if (capacity_ == std::numeric_limits<int64_t>::max()) return false;
  const auto end = operation.offset + static_cast<int64_t>(operation.data.size());
  const int64_t size = BytesOf(operation.path);
  return end > size && bytes_used() + end - size > capacity_;
}

int FaultDisk::Perform(DiskOperation operation, absl::FunctionRef<int()> perform) {
  std::lock_guard lock(mutex_);
  const int error = ErrorOf(operation);
  operation.refused = error != SQLITE_OK;
  operations_.push_back(std::move(operation));
  if (error == SQLITE_OK) return perform();
  ++refusals_;
  return error;
}

void FaultDisk::Refuse(Refusal refusal, size_t count) {
  std::lock_guard lock(mutex_);
  refusal_ = refusal;
  end_of_refusal_ = operations_.size() + count;
}

void FaultDisk::SetCapacity(int64_t bytes) {
  std::lock_guard lock(mutex_);
  capacity_ = bytes;
}

void FaultDisk::StopRefusing() {
  std::lock_guard lock(mutex_);
  refusal_.reset();
  capacity_ = std::numeric_limits<int64_t>::max();
}

std::vector<DiskOperation> FaultDisk::operations() const {
  std::lock_guard lock(mutex_);
  return operations_;
}

int64_t FaultDisk::BytesOf(const std::string& path) const {
  std::error_code none;
  const auto bytes = std::filesystem::file_size(RealPath(path), none);
  return none ? 0 : static_cast<int64_t>(bytes);
}

int64_t FaultDisk::bytes_used() const {
  std::lock_guard lock(mutex_);
  int64_t bytes = 0;
  for (const auto& [path, number] : numbers_) bytes += BytesOf(path);
  return bytes;
}

}  // namespace ballpiston::server
