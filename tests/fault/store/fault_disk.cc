#include "tests/fault/store/fault_disk.h"

#include <sqlite3.h>

#include <cstring>

namespace ballpiston::server {
namespace {

std::string UniqueName() {
  static std::atomic<int> made = 0;
  return "fault-disk-" + std::to_string(++made);
}

constexpr int kSqliteSectorBytes = 4096;  // what SQLite assumes on Unix

}  // namespace

// What SQLite allocates and passes back. `base` has to be first.
struct FaultDisk::OpenFile {
  sqlite3_file base;
  FaultDisk* disk;
  std::shared_ptr<File>* file;  // owned
  int lock;
  bool sync_folder;  // with the next sync
  bool uses_shm;
  unsigned read_locks;  // of shared memory, by bit
  unsigned write_locks;
};

// SQLite's methods: each finds its file and holds the disk's lock.
struct Methods {
  using OpenFile = FaultDisk::OpenFile;

  static OpenFile& Of(sqlite3_file* file) { return *reinterpret_cast<OpenFile*>(file); }
  static FaultDisk& Of(sqlite3_vfs* vfs) { return *static_cast<FaultDisk*>(vfs->pAppData); }
  static sqlite3_vfs* System() { return sqlite3_vfs_find("unix"); }

  // ---- files ----

  static int Close(sqlite3_file* handle) {
    OpenFile& open = Of(handle);
    Unlock(handle, SQLITE_LOCK_NONE);
    ShmUnmap(handle, 0);
    delete std::exchange(open.file, nullptr);
    return SQLITE_OK;
  }

  static int Read(sqlite3_file* handle, void* to, int bytes, sqlite3_int64 offset) {
    OpenFile& open = Of(handle);
    std::lock_guard lock(open.disk->mutex_);
    const std::string& contents = (*open.file)->contents;
    const auto size = static_cast<sqlite3_int64>(contents.size());
    const sqlite3_int64 there = std::clamp<sqlite3_int64>(size - offset, 0, bytes);
    if (there > 0) std::memcpy(to, contents.data() + offset, static_cast<size_t>(there));
    if (there == bytes) return SQLITE_OK;
    std::memset(static_cast<char*>(to) + there, 0, static_cast<size_t>(bytes - there));
    return SQLITE_IOERR_SHORT_READ;
  }

  static int Perform(OpenFile& open, DiskOperation operation) {
    operation.path = (*open.file)->path;
    operation.file = (*open.file)->number;
    if (open.disk->before_operation_) open.disk->before_operation_();
    std::lock_guard lock(open.disk->mutex_);
    return open.disk->Perform(std::move(operation));
  }

  static int Write(sqlite3_file* handle, const void* from, int bytes, sqlite3_int64 offset) {
    OpenFile& open = Of(handle);
    const std::string data(static_cast<const char*>(from), static_cast<size_t>(bytes));
    if (!(*open.file)->temporary) return Perform(open, {.offset = offset, .data = data});
    std::string& contents = (*open.file)->contents;
    contents.resize(std::max(contents.size(), static_cast<size_t>(offset) + data.size()));
    contents.replace(static_cast<size_t>(offset), data.size(), data);
    return SQLITE_OK;
  }

  static int Truncate(sqlite3_file* handle, sqlite3_int64 size) {
    OpenFile& open = Of(handle);
    if (!(*open.file)->temporary) {
      return Perform(open, {.kind = DiskOperation::Kind::kTruncate, .offset = size});
    }
    (*open.file)->contents.resize(static_cast<size_t>(size));
    return SQLITE_OK;
  }

  static int Sync(sqlite3_file* handle, int) {
    OpenFile& open = Of(handle);
    if ((*open.file)->temporary) return SQLITE_OK;
    const int code =
        Perform(open, {.kind = DiskOperation::Kind::kSync, .folder = open.sync_folder});
    if (code == SQLITE_OK) open.sync_folder = false;
    return code;
  }

  static int FileSize(sqlite3_file* handle, sqlite3_int64* size) {
    OpenFile& open = Of(handle);
    std::lock_guard lock(open.disk->mutex_);
    *size = static_cast<sqlite3_int64>((*open.file)->contents.size());
    return SQLITE_OK;
  }

  // ---- locks ----

  static int Lock(sqlite3_file* handle, int level) {
    OpenFile& open = Of(handle);
    std::lock_guard guard(open.disk->mutex_);
    if (open.lock >= level) return SQLITE_OK;
    FaultDisk::File& file = **open.file;
    const auto others = [&](const void* holder) { return holder != nullptr && holder != &open; };
    if (others(file.exclusive)) return SQLITE_BUSY;
    if (level == SQLITE_LOCK_SHARED) {
      if (others(file.pending)) return SQLITE_BUSY;
      ++file.shared;
    } else if (others(file.reserved) || others(file.pending)) {
      return SQLITE_BUSY;
    } else if (level == SQLITE_LOCK_RESERVED) {
      file.reserved = &open;
    } else {
      file.pending = &open;
      if (file.shared > 1) {
        open.lock = SQLITE_LOCK_PENDING;
        return SQLITE_BUSY;
      }
      file.exclusive = &open;
    }
    open.lock = level;
    return SQLITE_OK;
  }

  static int Unlock(sqlite3_file* handle, int level) {
    OpenFile& open = Of(handle);
    std::lock_guard guard(open.disk->mutex_);
    if (open.lock <= level) return SQLITE_OK;
    FaultDisk::File& file = **open.file;
    for (const void** holder : {&file.reserved, &file.pending, &file.exclusive}) {
      if (*holder == &open) *holder = nullptr;
    }
    if (level == SQLITE_LOCK_NONE) --file.shared;
    open.lock = level;
    return SQLITE_OK;
  }

  static int CheckReservedLock(sqlite3_file* handle, int* reserved) {
    OpenFile& open = Of(handle);
    std::lock_guard guard(open.disk->mutex_);
    *reserved = (*open.file)->reserved != nullptr ? 1 : 0;
    return SQLITE_OK;
  }

  // ---- shared memory ----

  static int ShmMap(sqlite3_file* handle, int region, int bytes, int extend, void volatile** at) {
    OpenFile& open = Of(handle);
    std::lock_guard guard(open.disk->mutex_);
    FaultDisk::Shm& shm = (*open.file)->shm;
    if (!std::exchange(open.uses_shm, true)) ++shm.users;
    *at = nullptr;
    const auto index = static_cast<size_t>(region);
    while (extend != 0 && shm.regions.size() <= index) {
      shm.regions.push_back(std::make_unique<std::vector<char>>(static_cast<size_t>(bytes)));
    }
    if (index < shm.regions.size()) *at = shm.regions[index]->data();
    return SQLITE_OK;
  }

  static bool ShmBlocked(const FaultDisk::Shm& shm, const OpenFile& open, size_t i, bool shared) {
    const unsigned bit = 1u << i;
    if (shm.writer[i] && (open.write_locks & bit) == 0) return true;
    const int own = (open.read_locks & bit) != 0 ? 1 : 0;
    return !shared && shm.readers[i] > own;
  }

  static int ShmLock(sqlite3_file* handle, int offset, int count, int flags) {
    OpenFile& open = Of(handle);
    std::lock_guard guard(open.disk->mutex_);
    FaultDisk::Shm& shm = (*open.file)->shm;
    const bool shared = (flags & SQLITE_SHM_SHARED) != 0;
    const auto first = static_cast<size_t>(offset);
    const size_t last = first + static_cast<size_t>(count);
    if ((flags & SQLITE_SHM_UNLOCK) != 0) {
      for (size_t i = first; i < last; ++i) ShmRelease(shm, open, i);
      return SQLITE_OK;
    }
    for (size_t i = first; i < last; ++i) {
      if (ShmBlocked(shm, open, i, shared)) return SQLITE_BUSY;
    }
    for (size_t i = first; i < last; ++i) ShmTake(shm, open, i, shared);
    return SQLITE_OK;
  }

  static void ShmTake(FaultDisk::Shm& shm, OpenFile& open, size_t i, bool shared) {
    const unsigned bit = 1u << i;
    if (!shared) {
      shm.writer[i] = true;
      open.write_locks |= bit;
    } else if ((open.read_locks & bit) == 0) {
      ++shm.readers[i];
      open.read_locks |= bit;
    }
  }

  static void ShmRelease(FaultDisk::Shm& shm, OpenFile& open, size_t i) {
    const unsigned bit = 1u << i;
    if ((open.write_locks & bit) != 0) shm.writer[i] = false;
    if ((open.read_locks & bit) != 0) --shm.readers[i];
    open.write_locks &= ~bit;
    open.read_locks &= ~bit;
  }

  static void ShmBarrier(sqlite3_file* handle) {
    std::lock_guard guard(Of(handle).disk->mutex_);  // orders what was written before and after
  }

  // The last user frees the memory. SQLite's own file system empties the file for its first user.
  static int ShmUnmap(sqlite3_file* handle, int) {
    OpenFile& open = Of(handle);
    std::lock_guard guard(open.disk->mutex_);
    if (!std::exchange(open.uses_shm, false)) return SQLITE_OK;
    FaultDisk::Shm& shm = (*open.file)->shm;
    for (size_t i = 0; i < FaultDisk::kShmLocks; ++i) ShmRelease(shm, open, i);
    if (--shm.users == 0) shm.regions.clear();
    return SQLITE_OK;
  }

  static int FileControl(sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; }
  static int SectorSize(sqlite3_file*) { return kSqliteSectorBytes; }
  static int DeviceCharacteristics(sqlite3_file*) { return SQLITE_IOCAP_POWERSAFE_OVERWRITE; }

  // ---- the file system ----

  static int OpenPath(sqlite3_vfs* vfs, const char* path, sqlite3_file* handle, int flags,
                      int* flags_out) {
    handle->pMethods = nullptr;
    OpenFile& open = Of(handle);
    const int code = Of(vfs).Open(path, flags, open);
    if (code != SQLITE_OK) return code;
    handle->pMethods = &kFile;
    if (flags_out != nullptr) *flags_out = flags;
    return SQLITE_OK;
  }

  static int Delete(sqlite3_vfs* vfs, const char* path, int sync_folder) {
    return Of(vfs).Delete(path, sync_folder != 0);
  }

  static int Access(sqlite3_vfs* vfs, const char* path, int, int* found) {
    *found = Of(vfs).Exists(path) ? 1 : 0;
    return SQLITE_OK;
  }

  static int FullPathname(sqlite3_vfs*, const char* path, int bytes, char* full) {
    sqlite3_snprintf(bytes, full, "%s", path);
    return SQLITE_OK;
  }

  // Not random: the same trace gives the same bytes.
  static int Randomness(sqlite3_vfs* vfs, int bytes, char* to) {
    FaultDisk& disk = Of(vfs);
    std::lock_guard lock(disk.mutex_);
    for (int i = 0; i < bytes; ++i) {
      disk.random_ = disk.random_ * 6364136223846793005u + 1442695040888963407u;
      to[i] = static_cast<char>(disk.random_ >> 56);
    }
    return bytes;
  }

  static int Sleep(sqlite3_vfs*, int microseconds) {
    return System()->xSleep(System(), microseconds);
  }
  static int CurrentTime(sqlite3_vfs*, double* days) {
    return System()->xCurrentTime(System(), days);
  }
  static int LastError(sqlite3_vfs*, int, char*) { return 0; }

  static const sqlite3_io_methods kFile;
};

const sqlite3_io_methods Methods::kFile = {2,
                                           Close,
                                           Read,
                                           Write,
                                           Truncate,
                                           Sync,
                                           FileSize,
                                           Lock,
                                           Unlock,
                                           CheckReservedLock,
                                           FileControl,
                                           SectorSize,
                                           DeviceCharacteristics,
                                           ShmMap,
                                           ShmLock,
                                           ShmBarrier,
                                           ShmUnmap,
                                           nullptr,
                                           nullptr};

FaultDisk::FaultDisk(DiskFiles files) : name_(UniqueName()), initial_(std::move(files)) {
  for (const auto& [path, contents] : initial_) {
    auto file = std::make_shared<File>();
    file->number = next_file_++;
    file->path = path;
    file->contents = contents;
    files_.emplace(path, std::move(file));
  }
  registered_ = std::make_unique<sqlite3_vfs>();
  *registered_ = {};
  registered_->iVersion = 1;
  registered_->szOsFile = sizeof(OpenFile);
  registered_->mxPathname = 512;
  registered_->zName = name_.c_str();
  registered_->pAppData = this;
  registered_->xOpen = Methods::OpenPath;
  registered_->xDelete = Methods::Delete;
  registered_->xAccess = Methods::Access;
  registered_->xFullPathname = Methods::FullPathname;
  registered_->xRandomness = Methods::Randomness;
  registered_->xSleep = Methods::Sleep;
  registered_->xCurrentTime = Methods::CurrentTime;
  registered_->xGetLastError = Methods::LastError;
  sqlite3_vfs_register(registered_.get(), 1);
}

FaultDisk::~FaultDisk() { sqlite3_vfs_unregister(registered_.get()); }

int FaultDisk::Open(const char* path, int flags, OpenFile& open) {
  std::lock_guard lock(mutex_);
  const bool temporary = path == nullptr;
  std::shared_ptr<File> file;
  const auto found = temporary ? files_.end() : files_.find(path);
  bool made = false;
  if (found != files_.end()) {
    file = found->second;
  } else if (!temporary && (flags & SQLITE_OPEN_CREATE) == 0) {
    return SQLITE_CANTOPEN;
  } else {
    file = std::make_shared<File>();
    file->temporary = temporary;
    file->number = next_file_++;
    if (!temporary) {
      file->path = path;
      files_.emplace(path, file);
      made = true;
    }
  }
  if (made) Perform({.kind = DiskOperation::Kind::kCreate, .path = path, .file = file->number});
  constexpr int kLogs = SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL | SQLITE_OPEN_WAL;
  const bool is_new_log = (flags & SQLITE_OPEN_CREATE) != 0 && (flags & kLogs) != 0;
  open.disk = this;
  open.file = new std::shared_ptr<File>(std::move(file));
  open.lock = SQLITE_LOCK_NONE;
  open.sync_folder = is_new_log;
  open.uses_shm = false;
  open.read_locks = 0;
  open.write_locks = 0;
  return SQLITE_OK;
}

int FaultDisk::Delete(const std::string& path, bool sync_folder) {
  std::lock_guard lock(mutex_);
  const auto found = files_.find(path);
  if (found == files_.end()) return SQLITE_IOERR_DELETE_NOENT;
  const int number = found->second->number;
  return Perform(
      {.kind = DiskOperation::Kind::kDelete, .path = path, .file = number, .folder = sync_folder});
}

bool FaultDisk::Exists(const std::string& path) {
  std::lock_guard lock(mutex_);
  const auto found = files_.find(path);
  return found != files_.end() && !found->second->contents.empty();
}

bool FaultDisk::Refuses(const DiskOperation& operation) const {
  const bool is_write = operation.kind == DiskOperation::Kind::kWrite;
  if (is_write && OutgrowsCapacity(operation)) return true;
  if (!refusal_) return false;
  const bool meant =
      *refusal_ == Refusal::kSyncError ? operation.kind == DiskOperation::Kind::kSync : is_write;
  const size_t number = operations_.size();
  return meant && number >= first_refused_ && number - first_refused_ < refused_count_;
}

bool FaultDisk::OutgrowsCapacity(const DiskOperation& operation) const {
  const auto end = operation.offset + static_cast<int64_t>(operation.data.size());
  const auto size = static_cast<int64_t>(files_.at(operation.path)->contents.size());
  return end > size && BytesUsed() + end - size > capacity_;
}

int FaultDisk::CodeOf(const DiskOperation& operation) const {
  if (operation.kind == DiskOperation::Kind::kSync) return SQLITE_IOERR_FSYNC;
  return refusal_ == Refusal::kWriteError ? SQLITE_IOERR_WRITE : SQLITE_FULL;
}

int FaultDisk::Perform(DiskOperation operation) {
  operation.refused = Refuses(operation);
  operations_.push_back(operation);
  if (operation.refused) {
    ++refusals_;
    return CodeOf(operation);
  }
  if (operation.kind == DiskOperation::Kind::kDelete) {
    files_.erase(operation.path);
    return SQLITE_OK;
  }
  std::string& contents = files_.at(operation.path)->contents;
  const auto offset = static_cast<size_t>(operation.offset);
  if (operation.kind == DiskOperation::Kind::kTruncate) contents.resize(offset);
  if (operation.kind == DiskOperation::Kind::kWrite) {
    contents.resize(std::max(contents.size(), offset + operation.data.size()));
    contents.replace(offset, operation.data.size(), operation.data);
  }
  return SQLITE_OK;
}

void FaultDisk::Refuse(Refusal refusal, size_t first, size_t count) {
  std::lock_guard lock(mutex_);
  refusal_ = refusal;
  first_refused_ = first;
  refused_count_ = count;
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

size_t FaultDisk::operation_count() const {
  std::lock_guard lock(mutex_);
  return operations_.size();
}

int64_t FaultDisk::refusals() const {
  std::lock_guard lock(mutex_);
  return refusals_;
}

std::vector<DiskOperation> FaultDisk::operations() const {
  std::lock_guard lock(mutex_);
  return operations_;
}

int64_t FaultDisk::BytesUsed() const {
  int64_t bytes = 0;
  for (const auto& [path, file] : files_) bytes += static_cast<int64_t>(file->contents.size());
  return bytes;
}

int64_t FaultDisk::bytes_used() const {
  std::lock_guard lock(mutex_);
  return BytesUsed();
}

}  // namespace ballpiston::server
