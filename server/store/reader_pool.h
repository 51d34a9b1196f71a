// Read-only connections to the store, which the calls that read share. Thread-safe.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "server/mutex.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

class ReaderPool {
 public:
  // Adds a connection. Call before the first Read.
  absl::Status Add(const std::string& path);

  // Runs `read` on one of the connections, in a transaction: it sees the store at one moment. Waits
  // while all connections are in use. UNAVAILABLE after Close.
  absl::Status Read(absl::FunctionRef<void(Database&)> read);

  // Waits for the connections in use.
  void Close();

 private:
  std::unique_ptr<Database> Take();  // null: closed
  void GiveBack(std::unique_ptr<Database> reader);

  Mutex mutex_;
  Condition changed_;
  std::vector<std::unique_ptr<Database>> free_ ABSL_GUARDED_BY(mutex_);
  size_t in_use_ ABSL_GUARDED_BY(mutex_) = 0;
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace ballpiston::server
