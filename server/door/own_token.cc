#include "server/door/own_token.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "server/door/new_token.h"
#include "server/store/data_directory.h"

namespace ballpiston::server {
namespace {

// A new file of mode 0600. False on an error, which is in errno.
bool WriteNewFile(const std::string& path, const std::string& text) {
  unlink(path.c_str());
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) return false;
  const bool written =
      write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  return close(descriptor) == 0 && written;
}

}  // namespace

std::string OwnToken::DefaultFolder() {
  char machine[HOST_NAME_MAX + 1] = {};
  gethostname(machine, HOST_NAME_MAX);
  return absl::StrCat(DataDirectory::Default(), "/tokens/", machine);
}

OwnToken::OwnToken() : token_(RandomToken()) {}

absl::Status OwnToken::Publish(const std::string& folder, const std::string& address) {
  std::error_code ignored;  // the file cannot be written then
  std::filesystem::create_directories(folder, ignored);
  chmod(folder.c_str(), 0700);
  path_ = absl::StrCat(folder, "/", address);
  const std::string part = absl::StrCat(path_, ".part");
  if (WriteNewFile(part, token_ + "\n") && rename(part.c_str(), path_.c_str()) == 0) {
    return absl::OkStatus();
  }
  return absl::PermissionDeniedError(absl::StrCat(path_, ": ", std::strerror(errno)));
}

OwnToken::~OwnToken() {
  std::string stored;
  std::ifstream(path_) >> stored;
  if (stored == token_) unlink(path_.c_str());
}

}  // namespace ballpiston::server
