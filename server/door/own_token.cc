#include "server/door/own_token.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/data_directory.h"

namespace ballpiston::server {
namespace {

// A new file of mode 0600. False on an error, which is in errno.
bool WriteNewFile(const std::string& path, absl::string_view text) {
  unlink(path.c_str());
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) return false;
  const bool written =
      write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  return close(descriptor) == 0 && written;
}

}  // namespace

std::string OwnToken::DefaultFolder() { return absl::StrCat(DataDirectory::Default(), "/tokens"); }

absl::StatusOr<OwnToken> OwnToken::Write(const std::string& folder, const std::string& address,
                                         absl::string_view token) {
  std::error_code ignored;  // the file cannot be written then
  std::filesystem::create_directories(folder, ignored);
  chmod(folder.c_str(), 0700);
  const std::string path = absl::StrCat(folder, "/", address);
  const std::string part = absl::StrCat(path, ".part");
  if (WriteNewFile(part, absl::StrCat(token, "\n")) && rename(part.c_str(), path.c_str()) == 0) {
    return OwnToken(path);
  }
  return absl::PermissionDeniedError(absl::StrCat(path, ": ", std::strerror(errno)));
}

OwnToken::OwnToken(OwnToken&& other) noexcept : path_(std::exchange(other.path_, {})) {}

OwnToken::~OwnToken() {
  if (!path_.empty()) unlink(path_.c_str());
}

}  // namespace ballpiston::server
