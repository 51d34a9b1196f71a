#include "server/worker/checked_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "server/store/folder_sync.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace ballpiston::server {
namespace {

// The first byte is not text, and the line ends show a transfer that changed them.
constexpr absl::string_view kMagic("\211BPW\r\n\032\n", 8);
constexpr size_t kVersionAt = 8, kKindAt = 12, kLengthAt = 16, kHeader = 24, kChecksum = 16;
static_assert(kHeader + kChecksum == kFrameBytes);

// ---- bytes ----

void Append(uint64_t number, size_t bytes, std::string& text) {
  for (size_t i = 0; i < bytes; ++i) text.push_back(static_cast<char>(number >> (8 * i) & 0xff));
}

uint64_t NumberAt(absl::string_view text, size_t at, size_t bytes) {
  uint64_t number = 0;
  for (size_t i = bytes; i-- > 0;) number = number << 8 | static_cast<unsigned char>(text[at + i]);
  return number;
}

std::string ChecksumOf(absl::string_view text) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(text.data(), text.size()));
  return {reinterpret_cast<const char*>(canonical.digest), kChecksum};
}

absl::Status TooLarge(uint64_t bytes) {
  return absl::ResourceExhaustedError(
      absl::StrCat("has ", bytes, " bytes; permitted: at most ", kMaxCheckedFile));
}

absl::Status CheckBeginning(FileKind kind, absl::string_view file) {
  const size_t known = std::min(file.size(), kMagic.size());
  if (file.substr(0, known) != kMagic.substr(0, known)) {
    return absl::InvalidArgumentError("is not a file of ballpiston");
  }
  if (file.size() < kFrameBytes) {
    return absl::OutOfRangeError(absl::StrCat("is truncated: it has only ", file.size(), " bytes"));
  }
  const uint64_t version = NumberAt(file, kVersionAt, 4), found = NumberAt(file, kKindAt, 4);
  if (version != kFormatVersion) {
    return absl::UnimplementedError(absl::StrCat("has format version ", version,
                                                 "; this program knows version ", kFormatVersion));
  }
  if (found == static_cast<uint64_t>(kind)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("is a file of kind ", found, "; expected: kind ", static_cast<uint32_t>(kind)));
}

// ---- files ----

absl::Status About(const std::string& path, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat("file ", path, " ", status.message()));
}

bool IsFull(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;  // EFBIG: the limit of the process
}

absl::Status CannotBeWritten(int error) {
  const std::string text = absl::StrCat("cannot be written: ", std::strerror(error));
  return IsFull(error) ? absl::ResourceExhaustedError(text) : absl::UnavailableError(text);
}

absl::Status CannotBeOpened(int error) {
  if (error == ENOENT) return absl::NotFoundError("does not exist");
  if (error == ELOOP) return absl::FailedPreconditionError("is a symbolic link");
  const std::string text = absl::StrCat("cannot be opened: ", std::strerror(error));
  return error == EACCES ? absl::PermissionDeniedError(text) : absl::UnavailableError(text);
}

absl::Status CheckFile(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return CannotBeOpened(errno);
  if (!S_ISREG(status.st_mode)) return absl::FailedPreconditionError("is not a regular file");
  if (status.st_uid != geteuid()) {
    return absl::PermissionDeniedError(absl::StrCat("belongs to user ", status.st_uid,
                                                    "; permitted: this user (", geteuid(), ")"));
  }
  const auto bytes = static_cast<uint64_t>(status.st_size);
  return bytes > kMaxCheckedFile ? TooLarge(bytes) : absl::OkStatus();
}

absl::StatusOr<std::string> ReadAll(int descriptor) {
  std::string text;
  char buffer[1 << 16];
  while (text.size() <= kMaxCheckedFile) {
    const ssize_t size = read(descriptor, buffer, sizeof(buffer));
    if (size == 0) return text;
    if (size > 0) text.append(buffer, static_cast<size_t>(size));
    if (size < 0 && errno != EINTR) {
      return absl::UnavailableError(absl::StrCat("cannot be read: ", std::strerror(errno)));
    }
  }
  return TooLarge(text.size());
}

// The file that is checked is the file that is read. O_NONBLOCK: opening a pipe must not wait.
absl::StatusOr<std::string> ReadBytes(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return CannotBeOpened(errno);
  const absl::Cleanup closed = [descriptor] { close(descriptor); };
  const absl::Status checked = CheckFile(descriptor);
  if (!checked.ok()) return checked;
  return ReadAll(descriptor);
}

bool WriteAll(int descriptor, absl::string_view text) {
  while (!text.empty()) {
    const ssize_t size = write(descriptor, text.data(), text.size());
    if (size > 0) text.remove_prefix(static_cast<size_t>(size));
    if (size < 0 && errno != EINTR) return false;
  }
  return true;
}

// Close can report that a network disk is full.
absl::Status WriteNewFile(const std::string& path, absl::string_view text) {
  const int descriptor =
      open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (descriptor < 0) return CannotBeWritten(errno);
  const bool is_written = WriteAll(descriptor, text) && fsync(descriptor) == 0;
  const int error = errno;
  if (!is_written) {
    close(descriptor);
    return CannotBeWritten(error);
  }
  return close(descriptor) == 0 ? absl::OkStatus() : CannotBeWritten(errno);
}

// Other machines write to the same folder, so the number of the process would not be unique.
absl::StatusOr<std::string> TemporaryName(const std::string& path) {
  uint64_t number = 0;
  if (getrandom(&number, sizeof(number), 0) != sizeof(number)) {
    return absl::UnavailableError(absl::StrCat("cannot be named: ", std::strerror(errno)));
  }
  return absl::StrCat(path, ".", absl::Hex(number, absl::kZeroPad16), ".tmp");
}

absl::Status CompareWithExisting(const std::string& path, absl::string_view text) {
  const absl::StatusOr<std::string> found = ReadBytes(path);
  if (!found.ok()) return found.status();
  if (*found == text) return absl::OkStatus();
  return absl::AlreadyExistsError("exists with other bytes");
}

// Some network file systems cannot refuse to replace a file. There the check is made before.
absl::Status Rename(const std::string& from, const std::string& to, absl::string_view text) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) {
    return absl::OkStatus();
  }
  int error = errno;
  if ((error == EINVAL || error == ENOSYS) &&
      faccessat(AT_FDCWD, to.c_str(), F_OK, AT_SYMLINK_NOFOLLOW) != 0) {
    if (rename(from.c_str(), to.c_str()) == 0) return absl::OkStatus();
    error = errno;
  }
  unlink(from.c_str());
  const bool exists = error == EEXIST || error == EINVAL || error == ENOSYS;
  return exists ? CompareWithExisting(to, text) : CannotBeWritten(error);
}

absl::Status WriteBytes(const std::string& path, absl::string_view text) {
  if (text.size() > kMaxCheckedFile) return TooLarge(text.size());
  const absl::StatusOr<std::string> temporary = TemporaryName(path);
  if (!temporary.ok()) return temporary.status();
  absl::Status written = WriteNewFile(*temporary, text);
  if (!written.ok()) {
    unlink(temporary->c_str());
    return written;
  }
  return Rename(*temporary, path, text);
}

}  // namespace

std::string FrameOf(FileKind kind, absl::string_view payload) {
  std::string file(kMagic);
  file.reserve(payload.size() + kFrameBytes);
  Append(kFormatVersion, 4, file);
  Append(static_cast<uint64_t>(kind), 4, file);
  Append(payload.size(), 8, file);
  file.append(payload.data(), payload.size());
  return file + ChecksumOf(file);
}

absl::StatusOr<absl::string_view> PayloadOf(FileKind kind, absl::string_view file) {
  if (file.size() > kMaxCheckedFile) return TooLarge(file.size());
  const absl::Status checked = CheckBeginning(kind, file);
  if (!checked.ok()) return checked;
  const uint64_t length = NumberAt(file, kLengthAt, 8), has = file.size() - kFrameBytes;
  if (length > has) {
    return absl::OutOfRangeError(
        absl::StrCat("is truncated: it has ", has, " of ", length, " bytes of payload"));
  }
  const absl::string_view hashed = file.substr(0, file.size() - kChecksum);
  if (length != has || ChecksumOf(hashed) != file.substr(hashed.size())) {
    return absl::DataLossError("is corrupted: its checksum or its length is wrong");
  }
  return hashed.substr(kHeader);
}

absl::Status WriteCheckedFile(const std::string& path, FileKind kind, absl::string_view payload) {
  const absl::Status written = WriteBytes(path, FrameOf(kind, payload));
  return written.ok() ? SyncFolder(FolderOf(path)) : About(path, written);
}

absl::StatusOr<std::string> ReadCheckedFile(const std::string& path, FileKind kind) {
  const absl::StatusOr<std::string> file = ReadBytes(path);
  if (!file.ok()) return About(path, file.status());
  const absl::StatusOr<absl::string_view> payload = PayloadOf(kind, *file);
  if (!payload.ok()) return About(path, payload.status());
  return std::string(payload->data(), payload->size());
}

}  // namespace ballpiston::server
