#include "server/store/folder_sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {

absl::Status SyncNameOf(const std::string& path) {
  const std::filesystem::path above = std::filesystem::path(path).parent_path();
  const std::string folder = above.empty() ? std::string(".") : above.string();
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  const int error = errno;
  if (file >= 0) close(file);
  if (synced || error == EINVAL) return absl::OkStatus();  // EINVAL: this file system has no need
  return absl::UnavailableError(
      absl::StrCat("folder ", folder, " cannot be flushed: ", std::strerror(error)));
}

}  // namespace ballpiston::server
