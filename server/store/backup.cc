#include "server/store/backup.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "server/store/folder_sync.h"
#include "server/store/schema.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {
namespace {

absl::Status TargetExists(const std::string& target) {
  return absl::AlreadyExistsError(
      absl::StrCat("backup ", target, ": the file exists already; choose another name"));
}

absl::Status CannotWrite(const std::string& target, int error) {
  const std::string what =
      absl::StrCat("backup ", target, " cannot be written: ", std::strerror(error));
  if (error == ENOSPC || error == EDQUOT) return absl::ResourceExhaustedError(what);
  if (error == EIO) return absl::UnavailableError(what);
  return absl::PermissionDeniedError(what);
}

// An empty file beside the target, for its owner only. The destructor removes it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& target) : path_(target + ".XXXXXX") {
    const int file = mkostemp(path_.data(), O_CLOEXEC);
    error_ = file < 0 ? errno : 0;
    if (file >= 0) close(file);
  }
  ~TemporaryFile() {
    if (error_ == 0) unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int error() const { return error_; }  // 0: the file was created
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int error_ = 0;
};

absl::Status Sync(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  const int error = errno;
  if (file >= 0) close(file);
  return synced ? absl::OkStatus() : CannotWrite(path, error);
}

}  // namespace

absl::StatusOr<StoreSummary> BackupStore(const std::string& store, const std::string& target) {
  struct stat found {};
  if (lstat(target.c_str(), &found) == 0) return TargetExists(target);
  const auto source = OpenStoreToRead(store);
  if (!source.ok()) return source.status();
  const TemporaryFile copy(target);
  if (copy.error() != 0) return CannotWrite(target, copy.error());
  (*source)->Run("VACUUM INTO ?", copy.path());  // it is not in WAL mode and has no free pages
  if (!(*source)->status().ok()) return (*source)->TakeStatus();
  absl::StatusOr<StoreSummary> summary = CheckStore(copy.path());
  if (!summary.ok()) return summary.status();
  if (!summary->sound()) {
    return absl::DataLossError(absl::StrCat("backup ", target, " was not made: store ", store,
                                            " is damaged (", summary->problems.front(),
                                            "); see --check"));
  }
  absl::Status placed = Sync(copy.path());
  if (!placed.ok()) return placed;
  if (rename(copy.path().c_str(), target.c_str()) != 0) return CannotWrite(target, errno);
  placed = SyncFolder(FolderOf(target));
  if (!placed.ok()) return placed;
  return summary;
}

}  // namespace ballpiston::server
