#include "server/door/published_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

bool Fill(int descriptor, absl::string_view content, time_t changed) {
  const timespec times[2] = {{changed, 0}, {changed, 0}};
  return write(descriptor, content.data(), content.size()) ==
             static_cast<ssize_t>(content.size()) &&
         fchmod(descriptor, 0600) == 0 && futimens(descriptor, times) == 0;
}

}  // namespace

PublishedFile::~PublishedFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

absl::Status PublishedFile::Publish(absl::string_view content) {
  const time_t changed = std::max(time(nullptr), changed_ + 1);
  int next = memfd_create("ballpiston", MFD_CLOEXEC);
  const absl::Cleanup closed = [&next] { close(next); };
  if (next < 0 || !Fill(next, content, changed)) {
    return absl::InternalError(
        absl::StrCat("no memory for the certificates in use: ", std::strerror(errno)));
  }
  changed_ = changed;
  if (descriptor_ < 0) {
    descriptor_ = std::exchange(next, -1);
    return absl::OkStatus();
  }
  // Replaces one file by the other in one step. With two open descriptors it fails only with EINTR
  // or, during an open(2) of the same number, with EBUSY; both are temporary.
  while (dup3(next, descriptor_, O_CLOEXEC) < 0 && (errno == EINTR || errno == EBUSY)) {
  }
  return absl::OkStatus();
}

std::string PublishedFile::Path() const { return absl::StrCat("/proc/self/fd/", descriptor_); }

}  // namespace ballpiston::server
