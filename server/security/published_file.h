// A file in memory that other code reads by its path. Its content is exchanged as a whole: a reader
// sees the old content or the new one. The content never reaches a disk, so the file may hold a
// private key.
//
// The path is that of a descriptor, /proc/self/fd/N. It is valid only in this process, and as long
// as the object lives.
#pragma once

#include <time.h>

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

class PublishedFile {
 public:
  PublishedFile() = default;
  ~PublishedFile();
  PublishedFile(const PublishedFile&) = delete;
  PublishedFile& operator=(const PublishedFile&) = delete;

  // A prepared content, which Exchange publishes. Without Exchange it is dropped.
  class Next {
   public:
    Next(Next&& other) noexcept
        : descriptor_(std::exchange(other.descriptor_, -1)), changed_(other.changed_) {}
    Next& operator=(Next&& other) = delete;
    ~Next();

   private:
    friend class PublishedFile;
    Next(int descriptor, time_t changed) : descriptor_(descriptor), changed_(changed) {}

    int descriptor_;
    time_t changed_;
  };

  // The new content's time of change is at least a second later than the previous one's, so that a
  // reader that compares times notices the exchange. INTERNAL if the system has no memory or no
  // descriptor. One thread at a time; readers may read at any time.
  absl::StatusOr<Next> Prepare(absl::string_view content) const;

  // Cannot fail. A caller that prepares several files first can therefore exchange all of them or
  // none.
  void Exchange(Next next);

  // Prepare and Exchange. After an error the old content stays.
  absl::Status Publish(absl::string_view content);

  std::string Path() const;  // valid after the first Exchange

 private:
  int descriptor_ = -1;
  time_t changed_ = 0;
};

}  // namespace ballpiston::server
