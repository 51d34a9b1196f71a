// The files of a folder that machines share. The server and its workers use no others.
//
//   todo/.new                   the server writes a lease; no worker sees this name
//   todo/LEASE                  a lease that no worker has
//   taken/LEASE.WORKER          a worker has moved it here: it computes the lease
//   done/LEASE.WORKER.OUTCOME   the worker has ended with it (lease_file.h)
//
// Paths are relative to the folder. Errors, besides those that a function names:
//   RESOURCE_EXHAUSTED   the disk is full, or a file is too large
//   UNAVAILABLE          the folder does not exist, or cannot be used now
// Messages name the path. Tests have a folder in memory (tests/server/worker/fake_files.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace ballpiston::server {

// In bytes; a larger file is not read. The states of a gas of 10^6 cells at the start and at the
// end of a chunk take 150 MB.
inline constexpr size_t kMaxSharedFile = size_t{256} << 20;

// A changed file has another stamp.
struct FileStamp {
  absl::Time time;  // by the folder's own clock, which may differ from every other
  size_t bytes = 0;

  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

class SharedFiles {
 public:
  virtual ~SharedFiles() = default;

  // The names in a subfolder, in any order, without those that begin with a dot.
  virtual absl::StatusOr<std::vector<std::string>> List(const std::string& subfolder) = 0;

  // A new file. Another machine may see a part of it before this returns. After an error there is
  // no file, as far as the disk permits.
  virtual absl::StatusOr<FileStamp> Create(const std::string& path, absl::string_view bytes) = 0;

  // The bytes from `offset` on. NOT_FOUND; PERMISSION_DENIED unless it is a regular file of this
  // user, and no link.
  virtual absl::StatusOr<std::string> Read(const std::string& path, size_t offset) = 0;

  // On disk when this returns. After an error the file has as many bytes as before, as far as the
  // disk permits. NOT_FOUND.
  virtual absl::Status Append(const std::string& path, absl::string_view bytes) = 0;

  // One of several machines that move a file succeeds; the others get NOT_FOUND.
  virtual absl::Status Move(const std::string& from, const std::string& to) = 0;

  // Gives the file another time. NOT_FOUND.
  virtual absl::Status Touch(const std::string& path) = 0;
  virtual absl::StatusOr<FileStamp> Stamp(const std::string& path) = 0;  // NOT_FOUND
  virtual absl::Status Remove(const std::string& path) = 0;              // NOT_FOUND
};

// A folder of this machine's file systems, local or not.
class FolderFiles : public SharedFiles {
 public:
  explicit FolderFiles(std::string folder) : folder_(std::move(folder)) {}

  absl::StatusOr<std::vector<std::string>> List(const std::string& subfolder) override;
  absl::StatusOr<FileStamp> Create(const std::string& path, absl::string_view bytes) override;
  absl::StatusOr<std::string> Read(const std::string& path, size_t offset) override;
  absl::Status Append(const std::string& path, absl::string_view bytes) override;
  absl::Status Move(const std::string& from, const std::string& to) override;
  absl::Status Touch(const std::string& path) override;
  absl::StatusOr<FileStamp> Stamp(const std::string& path) override;
  absl::Status Remove(const std::string& path) override;

  std::string PathOf(const std::string& path) const { return folder_ + "/" + path; }

 private:
  const std::string folder_;
};

}  // namespace ballpiston::server
