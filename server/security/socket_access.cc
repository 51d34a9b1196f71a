#include "server/security/socket_access.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston::server {

absl::StatusOr<gid_t> FindGroup(const std::string& group) {
  // Not getgrnam_r, whose buffer has to grow with the group: the server looks up one group, once,
  // before its other threads look up anything.
  if (const struct group* found = getgrnam(group.c_str())) return found->gr_gid;
  uint32_t number = 0;
  // The kernel takes the greatest number for "leave it as it is".
  if (absl::SimpleAtoi(group, &number) && number != std::numeric_limits<uint32_t>::max()) {
    return number;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("--socket-group=", group,
                   ": there is no such group; permitted: the name or the number of a group that "
                   "the server's user belongs to"));
}

absl::Status SetSocketAccess(const std::string& path, const SocketAccess& access) {
  if (access.group && lchown(path.c_str(), static_cast<uid_t>(-1), *access.group) != 0) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--socket-group: ", path, " cannot be given to the group ", *access.group, " (",
        std::strerror(errno), "); permitted: a group that the server's user belongs to"));
  }
  if (access.IsOpenToOthers() &&
      fchmodat(AT_FDCWD, path.c_str(), access.mode, AT_SYMLINK_NOFOLLOW) != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("--socket-mode=%04o: %s cannot get this mode (%s)", access.mode, path,
                        std::strerror(errno)));
  }
  return absl::OkStatus();
}

}  // namespace ballpiston::server
