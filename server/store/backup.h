// A copy of a store, to be put in its place one day.
//
// The store is read through a read-only connection, at one moment, also while a server uses it; it
// is neither written nor checkpointed. The copy is one file that needs no log beside it.
//
// To restore: stop the server, move store.sqlite3, store.sqlite3-wal and store.sqlite3-shm away,
// copy the backup to store.sqlite3. A log left behind by mistake is noticed, and the store refused.
#ifndef BALLPISTON_SERVER_STORE_BACKUP_H_
#define BALLPISTON_SERVER_STORE_BACKUP_H_

#include <string>

#include "absl/status/statusor.h"
#include "server/store/check_store.h"

namespace ballpiston::server {

// Writes `target`, readable by its owner only, and returns what is in it. It is there when it is
// complete, checked (check_store.h) and on disk, or not at all.
//   ALREADY_EXISTS       there is something of that name
//   NOT_FOUND            no store
//   PERMISSION_DENIED    the target's folder cannot be written to
//   DATA_LOSS            the copy, and so the store, is damaged
//   RESOURCE_EXHAUSTED, UNAVAILABLE  the disk is full, or failed
//   FAILED_PRECONDITION  no store of ours, or a newer one
absl::StatusOr<StoreSummary> BackupStore(const std::string& store, const std::string& target);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_BACKUP_H_
