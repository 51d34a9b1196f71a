// Makes a consistent copy of a store.
//
// The backup reads the store through a read-only connection in one transaction, also while a server
// uses the store. It does not change the store. The copy is one file that needs no log beside it.
//
// To restore: stop the server, move store.sqlite3, store.sqlite3-wal and store.sqlite3-shm away,
// copy the backup to store.sqlite3. If an old log is left beside it by mistake, the server refuses
// the store.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "server/store/check_store.h"

namespace ballpiston::server {

// Writes `target`, readable by its owner only, and returns a summary of it. The file appears only
// when it is complete, checked (check_store.h) and on disk. For one thread at a time: meanwhile
// SIGHUP, SIGINT and SIGTERM end the program, and remove the unfinished file, unless they are
// ignored.
//   ALREADY_EXISTS       the target exists already
//   NOT_FOUND            no store
//   PERMISSION_DENIED    the target's folder cannot be written to
//   DATA_LOSS            the copy, and so the store, is damaged
//   RESOURCE_EXHAUSTED, UNAVAILABLE  the disk is full, or failed
//   FAILED_PRECONDITION  not a ballpiston store, or a newer one
absl::StatusOr<StoreSummary> BackupStore(const std::string& store, const std::string& target);

}  // namespace ballpiston::server
