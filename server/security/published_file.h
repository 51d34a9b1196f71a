// A file in memory that others read by its path, exchanged as a whole: a reader sees the old
// content or the new one. Nothing of it reaches a disk, which suits a private key.
//
// The path is one of a descriptor, /proc/self/fd/N, and valid in this process only, as long as the
// object lives.
#ifndef BALLPISTON_SERVER_SECURITY_PUBLISHED_FILE_H_
#define BALLPISTON_SERVER_SECURITY_PUBLISHED_FILE_H_

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

  // A content that is ready to be exchanged for the one that is read, or to be given up.
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

  // Each content's time of change is a later second than the last one's, so that a reader who
  // compares times sees that it was exchanged. INTERNAL if the system gives no memory or no
  // descriptor. One thread at a time; readers are free.
  absl::StatusOr<Next> Prepare(absl::string_view content) const;

  // Cannot fail, so that of several files all are exchanged or none.
  void Exchange(Next next);

  // Both at once; after an error the old content stays.
  absl::Status Publish(absl::string_view content);

  std::string Path() const;  // after the first Exchange

 private:
  int descriptor_ = -1;
  time_t changed_ = 0;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_PUBLISHED_FILE_H_
