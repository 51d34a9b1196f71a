#include "server/door/private_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston::server {
namespace {

// Checks the open file, so that nobody can exchange it between check and read.
absl::StatusOr<std::string> ReadChecked(const NamedFile& file, bool is_private) {
  const int descriptor = open(file.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    return Unusable(file, absl::StrCat("cannot be opened: ", std::strerror(errno)));
  }
  const absl::Cleanup closed = [descriptor] { close(descriptor); };
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    return Unusable(file, "is not a regular file");
  }
  const absl::Status kept =
      is_private ? CheckKeptPrivate(file, status, geteuid()) : absl::OkStatus();
  if (!kept.ok()) return kept;
  const auto size = static_cast<size_t>(status.st_size);
  if (size > kMaxSecurityFile) {
    return Unusable(file, absl::StrCat("is longer than ", kMaxSecurityFile, " bytes"));
  }
  std::string text(size, '\0');
  if (read(descriptor, text.data(), size) == status.st_size) return text;
  return Unusable(file, absl::StrCat("cannot be read: ", std::strerror(errno)));
}

}  // namespace

absl::Status Unusable(const NamedFile& file, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat(file.Text(), ": ", why));
}

absl::StatusOr<std::string> ReadPublicFile(const NamedFile& file) {
  return ReadChecked(file, false);
}

absl::StatusOr<std::string> ReadPrivateFile(const NamedFile& file) {
  return ReadChecked(file, true);
}

absl::Status CheckKeptPrivate(const NamedFile& file, const struct stat& status, uid_t user) {
  if (status.st_uid != user && status.st_uid != 0) {
    return Unusable(file, absl::StrFormat("belongs to user %d; permitted: this server's user (%d) "
                                          "or root",
                                          status.st_uid, user));
  }
  constexpr mode_t kForOthers = S_IWGRP | S_IXGRP | S_IRWXO;
  if ((status.st_mode & kForOthers) == 0) return absl::OkStatus();
  return Unusable(file,
                  absl::StrFormat("is open to other users (mode %04o); permitted: 0600, or 0640 "
                                  "at most (chmod 600 it)",
                                  status.st_mode & 07777));
}

}  // namespace ballpiston::server
