#include "tests/server/hanging_disk.h"

#include <sqlite3.h>

#include "absl/strings/str_cat.h"
#include "tests/support/await.h"

namespace ballpiston::server {

// SQLite's own structs, with other functions for writing. SQLite has pointers to the bases.
struct HangingDisk::Vfs : sqlite3_vfs {
  struct Methods : sqlite3_io_methods {
    const sqlite3_io_methods* original = nullptr;
    HangingDisk* disk = nullptr;
  };

  sqlite3_vfs* original = nullptr;
  Methods of_logs = {};

  static int Open(sqlite3_vfs* files, const char* path, sqlite3_file* file, int flags,
                  int* flags_out) {
    Vfs& own = *static_cast<Vfs*>(files);
    const int code = own.original->xOpen(own.original, path, file, flags, flags_out);
    if (code != SQLITE_OK || (flags & SQLITE_OPEN_WAL) == 0) return code;
    static_cast<sqlite3_io_methods&>(own.of_logs) = *file->pMethods;
    own.of_logs.original = file->pMethods;
    own.of_logs.xWrite = Write;
    file->pMethods = &own.of_logs;
    return code;
  }

  static int Write(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 offset) {
    const Methods& methods = *static_cast<const Methods*>(file->pMethods);
    methods.disk->Pass();
    return methods.original->xWrite(file, bytes, count, offset);
  }
};

HangingDisk::HangingDisk()
    : name_(absl::StrCat("hanging ", absl::Hex(reinterpret_cast<uintptr_t>(this)))),
      registered_(std::make_unique<Vfs>()) {
  sqlite3_vfs* const original = sqlite3_vfs_find(nullptr);
  static_cast<sqlite3_vfs&>(*registered_) = *original;
  registered_->original = original;
  registered_->zName = name_.c_str();
  registered_->xOpen = Vfs::Open;
  registered_->of_logs.disk = this;
  sqlite3_vfs_register(registered_.get(), 0);
}

HangingDisk::~HangingDisk() { sqlite3_vfs_unregister(registered_.get()); }

void HangingDisk::Hang() {
  std::lock_guard lock(mutex_);
  hangs_ = true;
}

void HangingDisk::AwaitHanging() {
  std::unique_lock lock(mutex_);
  AwaitNotified(changed_, lock, [this] { return waiting_ > 0; });
}

void HangingDisk::Resume() {
  std::lock_guard lock(mutex_);
  hangs_ = false;
  changed_.notify_all();
}

void HangingDisk::Pass() {
  std::unique_lock lock(mutex_);
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !hangs_; });
  --waiting_;
}

}  // namespace ballpiston::server
