#include "server/security/published_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

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

PublishedFile::Next::~Next() {
  if (descriptor_ >= 0) close(descriptor_);
}

absl::StatusOr<PublishedFile::Next> PublishedFile::Prepare(absl::string_view content) const {
  Next next(memfd_create("ballpiston", MFD_CLOEXEC), std::max(time(nullptr), changed_ + 1));
  if (next.descriptor_ >= 0 && Fill(next.descriptor_, content, next.changed_)) return next;
  return absl::InternalError(
      absl::StrCat("no memory for the certificates in use: ", std::strerror(errno)));
}

// dup3 replaces one file by the other in one step. With two open descriptors it fails only with
// EINTR or, during an open(2) of the same number, with EBUSY; both are temporary.
void PublishedFile::Exchange(Next next) {
  changed_ = next.changed_;
  if (descriptor_ < 0) {
    descriptor_ = std::exchange(next.descriptor_, -1);
    return;
  }
  while (dup3(next.descriptor_, descriptor_, O_CLOEXEC) < 0 && (errno == EINTR || errno == EBUSY)) {
  }
}

absl::Status PublishedFile::Publish(absl::string_view content) {
  absl::StatusOr<Next> next = Prepare(content);
  if (!next.ok()) return next.status();
  Exchange(*std::move(next));
  return absl::OkStatus();
}

std::string PublishedFile::Path() const { return absl::StrCat("/proc/self/fd/", descriptor_); }

}  // namespace ballpiston::server
