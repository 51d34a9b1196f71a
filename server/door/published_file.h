// A file in memory that other code reads by its path. Its content is exchanged as a whole: a reader
// sees the old content or the new one. The content never reaches a disk, so the file may hold a
// private key.
//
// The path is that of a descriptor, /proc/self/fd/N. It is valid only in this process, and as long
// as the object lives.
#pragma once

#include <time.h>

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

class PublishedFile {
 public:
  PublishedFile() = default;
  ~PublishedFile();
  PublishedFile(const PublishedFile&) = delete;
  PublishedFile& operator=(const PublishedFile&) = delete;

  // The content's time of change is at least a second later than the previous one's, so that a
  // reader that compares times notices the exchange. INTERNAL if the system has no memory or no
  // descriptor; then the old content stays. One thread at a time; readers may read at any time.
  absl::Status Publish(absl::string_view content);

  std::string Path() const;  // valid after the first Publish

 private:
  int descriptor_ = -1;
  time_t changed_ = 0;
};

}  // namespace ballpiston::server
