// Removes the log and its index that a reader leaves beside a store that no process had open.
//
// A read-only connection creates an empty log, but may not remove it. This class lets SQLite remove
// these files through a connection that can write. SQLite holds its locks meanwhile, so a server
// that starts at this moment keeps its files.
#pragma once

#include <string>

namespace ballpiston::server {

class UnusedLog {
 public:
  // Call before the store is opened for reading.
  explicit UnusedLog(std::string store);
  // Runs after the store is closed. Leaves a log that existed before.
  ~UnusedLog();
  UnusedLog(const UnusedLog&) = delete;
  UnusedLog& operator=(const UnusedLog&) = delete;

 private:
  const std::string store_;
  const bool was_there_;
};

}  // namespace ballpiston::server
