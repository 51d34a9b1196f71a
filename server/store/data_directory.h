// The folder with the server's state. One server at a time can use it.
//
// The server creates the folder if it does not exist, for its owner only. If other users can enter
// it, the server sets its mode to 0700 if it is empty or has a store, and logs this.
//
// Two files in it are for clients, and for further servers that find the lock:
//   lock            The server holds an exclusive lock (flock) on it as long as this object lives.
//                   The kernel releases the lock when the process ends, however it ends. The file
//                   contains the server's process id: one line of decimal digits.
//   server.address  One line: where the server listens. Written when it listens. If the
//                   lock contains the id of its holder, the address is of that server too.
//
// A client that wants to stop the server tests the lock, then reads the id, then sends SIGTERM:
//   - The file is not locked: no server is here. The file's content means nothing.
//   - It is locked and contains a line: that is the server's id. There is one exception: a server
//     that was killed leaves its id, and the next server replaces it only some microseconds after
//     it has taken the lock. The old id is that of a dead process: if there is no such process, or
//     it is not a ballpistond, read the file again.
//   - It is locked and empty: the server is about to write its id, or is ending, or the disk is
//     full. Retry.
// The server empties the file before it releases the lock. It never changes a file `lock` that
// contains something else, which another program must have written.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace ballpiston::server {

// The store's file in the folder.
inline constexpr char kStoreFile[] = "store.sqlite3";
// The bytes of the store's file with this path, and of its log.
int64_t StoreBytes(const std::string& path);

class DataDirectory {
 public:
  //   FAILED_PRECONDITION  another server uses the folder; the message has its address
  //   PERMISSION_DENIED    the folder cannot be created or written; or other users can enter it,
  //                        and it has files but no store, is another user's, or is shared (/tmp)
  static absl::StatusOr<DataDirectory> Open(const std::string& path);

  // $XDG_STATE_HOME/ballpiston, or ~/.local/state/ballpiston. The home is HOME if it is an
  // absolute path, else that of the user's entry of the system.
  static std::string Default();

  DataDirectory(DataDirectory&& other) noexcept;
  ~DataDirectory();  // calls Leave, then releases the lock

  // Writes the address file for clients and for further servers. They can do without it, so a disk
  // error is ignored.
  void TellAddress(const std::string& address) const;

  // Removes the address file and empties the lock's file. For a program that ends without
  // destructors.
  void Leave() const;

  // The folder's inode number. It stays the same after a move within a file system; a copy has
  // another.
  uint64_t Inode() const { return inode_; }

  const std::string& path() const { return path_; }
  std::string FilePath(const std::string& name) const { return path_ + "/" + name; }

 private:
  DataDirectory(std::string path, uint64_t inode, int lock);

  std::string path_;
  uint64_t inode_;
  int lock_;  // file descriptor
};

}  // namespace ballpiston::server
