// The log and its index that a reader leaves beside a store that nobody had open.
//
// A connection that only reads makes an empty log, and may not take it away again. They are taken
// away here by SQLite itself, through a connection that may: under its locks, so that a server that
// starts in this moment keeps what it has opened.
#ifndef BALLPISTON_SERVER_STORE_UNUSED_LOG_H_
#define BALLPISTON_SERVER_STORE_UNUSED_LOG_H_

#include <string>

namespace ballpiston::server {

class UnusedLog {
 public:
  // Before the store is opened to be read.
  explicit UnusedLog(std::string store);
  // When it is closed. Does nothing to a log that was there before.
  ~UnusedLog();
  UnusedLog(const UnusedLog&) = delete;
  UnusedLog& operator=(const UnusedLog&) = delete;

 private:
  const std::string store_;
  const bool was_there_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_UNUSED_LOG_H_
