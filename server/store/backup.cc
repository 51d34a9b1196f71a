#include "server/store/backup.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "absl/cleanup/cleanup.h"
#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "server/store/folder_sync.h"
#include "server/store/schema.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {
namespace {

absl::Status CannotWrite(const std::string& target, int error) {
  const std::string what =
      absl::StrCat("backup ", target, " cannot be written: ", std::strerror(error));
  if (error == ENOSPC || error == EDQUOT) return absl::ResourceExhaustedError(what);
  if (error == EIO) return absl::UnavailableError(what);
  const bool is_denied = error == EACCES || error == EPERM || error == EROFS;
  return is_denied ? absl::PermissionDeniedError(what) : absl::FailedPreconditionError(what);
}

absl::Status CheckIsFree(const std::string& target) {
  struct stat found {};
  if (lstat(target.c_str(), &found) != 0) return absl::OkStatus();
  return absl::AlreadyExistsError(
      absl::StrCat("backup ", target, ": the file exists already; choose another name"));
}

// The copy, and what SQLite writes beside it, until the copy is complete.
struct UnfinishedCopy {
  std::string file, journal = file + "-journal";

  void Remove() const {
    unlink(file.c_str());
    unlink(journal.c_str());
  }
};
const UnfinishedCopy* unfinished = nullptr;

// Handles a signal that ends the program.
void RemoveUnfinished(int signal) {
  unfinished->Remove();
  _exit(128 + signal);
}

constexpr std::array kEndings = {SIGHUP, SIGINT, SIGTERM};
using Actions = std::array<struct sigaction, kEndings.size()>;

// Returns the actions before. A signal that is ignored stays so: nohup ignores SIGHUP.
Actions RemoveUnfinishedAtSignals() {
  Actions before{};
  struct sigaction action {};
  action.sa_handler = &RemoveUnfinished;
  for (size_t i = 0; i < kEndings.size(); ++i) {
    sigaction(kEndings[i], nullptr, &before[i]);
    if (before[i].sa_handler != SIG_IGN) sigaction(kEndings[i], &action, nullptr);
  }
  return before;
}

void Restore(const Actions& before) {
  for (size_t i = 0; i < kEndings.size(); ++i) sigaction(kEndings[i], &before[i], nullptr);
}

}  // namespace

absl::StatusOr<StoreSummary> BackupStore(const std::string& store, const std::string& target) {
  absl::Status is_free = CheckIsFree(target);
  if (!is_free.ok()) return is_free;
  const auto source = OpenStoreToRead(store);
  if (!source.ok()) return source.status();
  std::string copy = target + ".XXXXXX";
  const int file = mkostemp(copy.data(), O_CLOEXEC);  // for its owner only
  if (file < 0) return CannotWrite(target, errno);
  const UnfinishedCopy made{copy};
  unfinished = &made;
  const Actions before = RemoveUnfinishedAtSignals();
  const absl::Cleanup remove = [&] {
    close(file);
    made.Remove();
    Restore(before);
  };
  (*source)->Run("VACUUM INTO ?", copy);  // it is not in WAL mode and has no free pages
  const absl::Status copied = (*source)->TakeStatus();
  if (IsOfTheDisk(copied)) {
    return absl::Status(copied.code(),
                        absl::StrCat("backup ", target, " was not made (", copied.message(),
                                     "); check its disk, and that of store ", store));
  }
  if (!copied.ok()) return copied;
  absl::StatusOr<StoreSummary> summary = CheckStore(copy);
  if (!summary.ok()) return summary.status();
  if (!summary->sound()) {
    return absl::DataLossError(absl::StrCat("backup ", target, " was not made: store ", store,
                                            " is damaged (", summary->problems.front(),
                                            "); see --check"));
  }
  if (fsync(file) != 0) return CannotWrite(target, errno);
  is_free = CheckIsFree(target);  // again: the copy may have taken minutes
  if (!is_free.ok()) return is_free;
  if (rename(copy.c_str(), target.c_str()) != 0) return CannotWrite(target, errno);
  const absl::Status synced = SyncNameOf(target);
  if (!synced.ok()) return synced;
  return summary;
}

}  // namespace ballpiston::server
