// The folder a server keeps its state in, held by one server at a time.
//
// Made, readable by its owner only, if it does not exist. One of our user's that others may enter
// is closed to them if it is empty or has been a server's, and that is logged.
//
// Two files in it are for clients, and for servers that are kept out:
//   lock            The server holds an exclusive lock (flock) on it as long as this object lives.
//                   The kernel releases the lock when the process ends, however it ends. The file
//                   contains the server's process id: one line of decimal digits.
//   server.address  One line: where the server listens. Written when it listens.
//
// A client that wants to stop the server tests the lock, then reads the id, then sends SIGTERM:
//   - The file is not locked: no server is here. The file's content means nothing.
//   - It is locked and contains a line: that is the server's id. There is one exception: a server
//     that was killed leaves its id, and the next server replaces it only some microseconds after
//     it has taken the lock. The old id is that of a dead process: if there is no such process, or
//     it is not a ballpistond, read the file again.
//   - It is locked and empty: the server is about to write its id, retry; or the disk is full.
// The server empties the file before it releases the lock. It never changes a file `lock` that
// contains something else, which another program must have written.
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
