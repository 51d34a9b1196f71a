#include "server/store/data_directory.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/status/log.h"
#include "server/store/folder_sync.h"

namespace ballpiston::server {
namespace {

constexpr char kLockFile[] = "lock";  // clients read both files (client/library/server_process.cc)
constexpr char kAddressFile[] = "server.address";
constexpr char kClientsLog[] = "server.log";  // log of a server that a client starts

// Whether the file contains nothing or a process id. If not, another program wrote it.
bool IsAServersLock(int file) {
  char text[32];
  const ssize_t size = pread(file, text, sizeof(text), 0);
  if (size < 0 || size == sizeof(text)) return false;
  return std::all_of(text, text + size, [](char c) { return absl::ascii_isdigit(c) || c == '\n'; });
}

bool EmptyLock(int file) { return IsAServersLock(file) && ftruncate(file, 0) == 0; }

// The file is emptied first, so a reader sees no mixture of two ids. Without the id the
// server works, but clients cannot stop it. So a disk that does not accept the id is no failure.
void WriteProcessId(int file) {
  if (!EmptyLock(file)) return;
  const std::string line = absl::StrCat(getpid(), "\n");
  [[maybe_unused]] const ssize_t written = pwrite(file, line.data(), line.size(), 0);
}

// Tries several times, because a client that tests the lock holds it for a moment. Returns errno.
int Lock(int file) {
  constexpr int kAttempts = 5;
  for (int attempt = 1; flock(file, LOCK_EX | LOCK_NB) != 0; ++attempt) {
    if (errno != EWOULDBLOCK || attempt == kAttempts) return errno;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return 0;
}

absl::Status NotWritable(const std::string& path, int error) {
  return absl::PermissionDeniedError(absl::StrCat("data folder ", path,
                                                  " is not writable: ", std::strerror(error),
                                                  "; choose another one with --data-dir"));
}

std::string AddressFile(const std::string& path) { return absl::StrCat(path, "/", kAddressFile); }

absl::Status InUse(const std::string& path) {
  std::string address;
  std::getline(std::ifstream(AddressFile(path)), address);
  const std::string where = address.empty() ? "" : absl::StrCat(", which listens on ", address);
  return absl::FailedPreconditionError(
      absl::StrCat("data folder ", path, " is in use by another ballpistond", where,
                   "; use that server (ballpiston --server), stop it, or choose another folder "
                   "with --data-dir"));
}

bool IsDirectory(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

// Makes the folder and those above it; each is for its owner only.
absl::Status MakeDirectories(const std::string& path) {
  if (IsDirectory(path)) return absl::OkStatus();
  const size_t slash = path.find_last_of('/');
  if (slash != std::string::npos && slash > 0) {
    const absl::Status above = MakeDirectories(path.substr(0, slash));
    if (!above.ok()) return above;
  }
  // Without this flush a power cut could remove the folder with all acknowledged data in it.
  if (mkdir(path.c_str(), 0700) == 0) return SyncNameOf(path);
  const int error = errno;
  return IsDirectory(path) ? absl::OkStatus() : NotWritable(path, error);
}

// Whether the folder has a store, is empty, or has only a client's log. Otherwise other users may
// need its files.
bool IsAServers(const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(absl::StrCat(path, "/", kStoreFile), error)) return true;
  std::filesystem::directory_iterator entry(path, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (entry->path().filename() != kClientsLog) return false;
  }
  return !error;
}

// Other users must not reach jobs, results and the socket.
absl::Status CloseToOthers(const std::string& path, const struct stat& found) {
  if (found.st_uid != geteuid()) {
    return absl::PermissionDeniedError(absl::StrCat("data folder ", path,
                                                    " belongs to another user (", found.st_uid,
                                                    "); choose another one with --data-dir"));
  }
  constexpr mode_t kForOthers = S_IRWXG | S_IRWXO;
  if ((found.st_mode & kForOthers) == 0) return absl::OkStatus();
  const std::string open = absl::StrFormat("data folder %s is open to other users (mode %04o)",
                                           path, found.st_mode & 07777);
  if ((found.st_mode & S_ISVTX) != 0 || !IsAServers(path)) {
    return absl::PermissionDeniedError(
        absl::StrCat(open, "; choose another one with --data-dir, or run chmod 700 ", path,
                     " if no other user needs its files"));
  }
  if (chmod(path.c_str(), 0700) != 0) return NotWritable(path, errno);
  LogInfo(absl::StrCat(open, ": the server sets its mode to 0700"));
  return absl::OkStatus();
}

}  // namespace

std::string DataDirectory::Default() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return absl::StrCat(state, "/ballpiston");
  const char* home = std::getenv("HOME");
  const bool is_absolute = home != nullptr && *home == '/';
  const passwd* user = is_absolute ? nullptr : getpwuid(getuid());
  if (!is_absolute) home = user == nullptr ? "" : user->pw_dir;
  return absl::StrCat(home, "/.local/state/ballpiston");
}

absl::StatusOr<DataDirectory> DataDirectory::Open(const std::string& path) {
  if (path.empty()) return absl::InvalidArgumentError("--data-dir is empty; name a folder");
  const absl::Status made = MakeDirectories(path);
  if (!made.ok()) return made;
  if (access(path.c_str(), W_OK | X_OK) != 0) return NotWritable(path, errno);
  struct stat folder {};
  if (stat(path.c_str(), &folder) != 0) return NotWritable(path, errno);
  const absl::Status closed = CloseToOthers(path, folder);
  if (!closed.ok()) return closed;
  const std::string lock_path = absl::StrCat(path, "/", kLockFile);
  const int lock = open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock < 0) return NotWritable(path, errno);
  const int error = Lock(lock);
  if (error == 0) {
    // A killed server left its address. It is removed before clients can read this server's id.
    unlink(AddressFile(path).c_str());
    WriteProcessId(lock);
    return DataDirectory(path, folder.st_ino, lock);
  }
  close(lock);
  return error == EWOULDBLOCK ? InUse(path) : NotWritable(path, error);
}

DataDirectory::DataDirectory(std::string path, uint64_t inode, int lock)
    : path_(std::move(path)), inode_(inode), lock_(lock) {}

DataDirectory::DataDirectory(DataDirectory&& other) noexcept
    : path_(std::move(other.path_)), inode_(other.inode_), lock_(std::exchange(other.lock_, -1)) {}

DataDirectory::~DataDirectory() {
  if (lock_ < 0) return;
  Leave();
  close(lock_);
}

void DataDirectory::Leave() const {
  unlink(AddressFile(path_).c_str());
  EmptyLock(lock_);
}

void DataDirectory::TellAddress(const std::string& address) const {
  std::ofstream(AddressFile(path_)) << address << "\n";
}

int64_t StoreBytes(const std::string& path) {
  int64_t bytes = 0;
  for (const char* file : {"", "-wal"}) {
    struct stat found {};
    if (stat(absl::StrCat(path, file).c_str(), &found) == 0) bytes += found.st_size;
  }
  return bytes;
}

}  // namespace ballpiston::server
