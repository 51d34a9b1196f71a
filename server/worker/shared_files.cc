#include "server/worker/shared_files.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

// ESTALE: another machine has removed the file while this one had it open.
absl::Status Failed(const std::string& path, const char* what, int error) {
  const std::string text = absl::StrCat(path, " ", what, ": ", std::strerror(error));
  if (error == ENOENT || error == ESTALE) return absl::NotFoundError(text);
  if (error == EACCES || error == ELOOP) return absl::PermissionDeniedError(text);
  const bool is_full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return is_full ? absl::ResourceExhaustedError(text) : absl::UnavailableError(text);
}

bool WriteAll(int descriptor, absl::string_view text) {
  while (!text.empty()) {
    const ssize_t size = write(descriptor, text.data(), text.size());
    if (size > 0) text.remove_prefix(static_cast<size_t>(size));
    if (size < 0 && errno != EINTR) return false;
  }
  return true;
}

FileStamp StampOf(const struct stat& status) {
  return {absl::TimeFromTimespec(status.st_mtim), static_cast<size_t>(status.st_size)};
}

absl::Status CheckFile(const std::string& path, const struct stat& status) {
  if (!S_ISREG(status.st_mode)) {
    return absl::PermissionDeniedError(absl::StrCat(path, " is not a regular file"));
  }
  if (status.st_uid != geteuid()) {
    return absl::PermissionDeniedError(absl::StrCat(path, " belongs to user ", status.st_uid,
                                                    "; permitted: this user (", geteuid(), ")"));
  }
  if (static_cast<uint64_t>(status.st_size) <= kMaxSharedFile) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat(path, " has ", status.st_size, " bytes; permitted: at most ", kMaxSharedFile));
}

}  // namespace

absl::StatusOr<std::vector<std::string>> FolderFiles::List(const std::string& subfolder) {
  const std::string path = PathOf(subfolder);
  DIR* const folder = opendir(path.c_str());
  if (folder == nullptr) {
    return absl::UnavailableError(Failed(path, "cannot be read", errno).message());
  }
  const absl::Cleanup closed = [folder] { closedir(folder); };
  std::vector<std::string> names;
  errno = 0;
  while (const dirent* const entry = readdir(folder)) {
    if (entry->d_name[0] != '.') names.emplace_back(entry->d_name);
    errno = 0;
  }
  if (errno != 0) return absl::UnavailableError(Failed(path, "cannot be read", errno).message());
  return names;
}

absl::StatusOr<FileStamp> FolderFiles::Create(const std::string& path, absl::string_view bytes) {
  const std::string whole = PathOf(path);
  const int descriptor = open(whole.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    const absl::Status failed = Failed(whole, "cannot be written", errno);
    return absl::IsNotFound(failed) ? absl::UnavailableError(failed.message()) : failed;
  }
  struct stat status {};
  const bool is_written = WriteAll(descriptor, bytes) && fstat(descriptor, &status) == 0;
  const int error = errno;
  // Close can report that a network disk is full.
  const bool is_closed = close(descriptor) == 0;
  if (is_written && is_closed) return StampOf(status);
  absl::Status failed = Failed(whole, "cannot be written", is_written ? errno : error);
  unlink(whole.c_str());
  return failed;
}

// The file that is checked is the file that is read. O_NONBLOCK: opening a pipe must not wait.
absl::StatusOr<std::string> FolderFiles::Read(const std::string& path, size_t offset) {
  const std::string whole = PathOf(path);
  const int descriptor = open(whole.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return Failed(whole, "cannot be opened", errno);
  const absl::Cleanup closed = [descriptor] { close(descriptor); };
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return Failed(whole, "cannot be read", errno);
  const absl::Status checked = CheckFile(whole, status);
  if (!checked.ok()) return checked;
  std::string text;
  char buffer[1 << 16];
  while (text.size() <= kMaxSharedFile) {
    const auto at = static_cast<off_t>(offset + text.size());
    const ssize_t size = pread(descriptor, buffer, sizeof(buffer), at);
    if (size == 0) break;
    if (size > 0) text.append(buffer, static_cast<size_t>(size));
    if (size < 0 && errno != EINTR) return Failed(whole, "cannot be read", errno);
  }
  return text;
}

absl::Status FolderFiles::Append(const std::string& path, absl::string_view bytes) {
  const std::string whole = PathOf(path);
  const int descriptor = open(whole.c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return Failed(whole, "cannot be written", errno);
  const off_t before = lseek(descriptor, 0, SEEK_END);
  const bool is_written = before >= 0 && WriteAll(descriptor, bytes) && fsync(descriptor) == 0;
  const int error = errno;
  if (!is_written) {
    const bool is_cut = before >= 0 && ftruncate(descriptor, before) == 0;
    close(descriptor);
    return Failed(whole, is_cut ? "cannot be written" : "cannot be written or cut", error);
  }
  return close(descriptor) == 0 ? absl::OkStatus() : Failed(whole, "cannot be written", errno);
}

// NFS may send the request twice, for example if the first answer is lost. Then the second answer
// is ENOENT, although the file has moved.
absl::Status FolderFiles::Move(const std::string& from, const std::string& to) {
  const std::string source = PathOf(from), target = PathOf(to);
  if (rename(source.c_str(), target.c_str()) == 0) return absl::OkStatus();
  const int error = errno;
  struct stat status {};
  const bool has_moved =
      error == ENOENT && lstat(target.c_str(), &status) == 0 && lstat(source.c_str(), &status) != 0;
  return has_moved ? absl::OkStatus() : Failed(source, "cannot be moved", error);
}

absl::Status FolderFiles::Touch(const std::string& path) {
  const std::string whole = PathOf(path);
  if (utimensat(AT_FDCWD, whole.c_str(), nullptr, AT_SYMLINK_NOFOLLOW) == 0) {
    return absl::OkStatus();
  }
  return Failed(whole, "cannot be touched", errno);
}

absl::StatusOr<FileStamp> FolderFiles::Stamp(const std::string& path) {
  const std::string whole = PathOf(path);
  struct stat status {};
  if (lstat(whole.c_str(), &status) == 0) return StampOf(status);
  return Failed(whole, "cannot be looked up", errno);
}

absl::Status FolderFiles::Remove(const std::string& path) {
  const std::string whole = PathOf(path);
  return unlink(whole.c_str()) == 0 ? absl::OkStatus() : Failed(whole, "cannot be removed", errno);
}

}  // namespace ballpiston::server
