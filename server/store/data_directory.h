// The folder a server keeps its state in, held by one server at a time.
//
// Made, readable by its owner only, if it does not exist. One of our user's that others may enter
// is closed to them if it is empty or has been a server's, and that is logged. A lock on the file
// `lock` in it, held as long as this object lives (and released by the kernel when the process
// dies), keeps a second server out, and tells clients that a server lives here. Where it listens is
// in the file `server.address`.
#ifndef BALLPISTON_SERVER_STORE_DATA_DIRECTORY_H_
#define BALLPISTON_SERVER_STORE_DATA_DIRECTORY_H_

#include <string>

#include "absl/status/statusor.h"

namespace ballpiston::server {

// The store, in it.
inline constexpr char kStoreFile[] = "store.sqlite3";

class DataDirectory {
 public:
  //   FAILED_PRECONDITION  another server uses it; the message says where that one listens
  //   PERMISSION_DENIED    it cannot be made or written to; or others may enter it, and it is not
  //                        ours to close: another user's, one that all users share, like /tmp,
  //                        or one with files in it that are not a server's
  static absl::StatusOr<DataDirectory> Open(const std::string& path);

  // $XDG_STATE_HOME/ballpiston, or ~/.local/state/ballpiston.
  static std::string Default();

  DataDirectory(DataDirectory&& other) noexcept;
  DataDirectory& operator=(DataDirectory&& other) noexcept;
  ~DataDirectory();

  // Tells clients, and servers that are kept out, where this one listens. They can do without: a
  // disk that does not take it is no failure.
  void TellAddress(const std::string& address) const;

  const std::string& path() const { return path_; }
  std::string FilePath(const std::string& name) const { return path_ + "/" + name; }

 private:
  DataDirectory(std::string path, int lock);

  std::string path_;
  int lock_;  // file descriptor
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_DATA_DIRECTORY_H_
