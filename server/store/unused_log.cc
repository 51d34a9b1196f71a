#include "server/store/unused_log.h"

#include <utility>

#include "server/store/sqlite.h"

namespace ballpiston::server {
namespace {

bool HasLog(const std::string& store) {
  return Database::Exists(store + "-wal") || Database::Exists(store + "-shm");
}

}  // namespace

UnusedLog::UnusedLog(std::string store) : store_(std::move(store)), was_there_(HasLog(store_)) {}

UnusedLog::~UnusedLog() {
  if (was_there_ || !HasLog(store_)) return;
  const auto database = Database::Open(store_, Database::Mode::kReadWrite);
  // After a read this connection uses the log. SQLite removes the log when its last user closes.
  if (database.ok()) (*database)->Integer("PRAGMA user_version").status().IgnoreError();
}

}  // namespace ballpiston::server
