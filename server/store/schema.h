// The tables of the store (server/README.md), and the checks of a file before it becomes a store.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

inline constexpr int64_t kSchemaVersion = 14;
inline constexpr int64_t kApplicationId = 0x62706973;  // "bpis"

// The connection that writes and checkpoints. Checks an existing store; creates a store if there is
// none. On an error the file is unchanged:
//   FAILED_PRECONDITION  damaged, of a newer version, or of another program
//   UNAVAILABLE          its disk is full or fails, or the file is not readable
//   PERMISSION_DENIED    the file is not writable
absl::StatusOr<std::unique_ptr<Database>> OpenStoreFile(const std::string& path);

// A read-only connection to a store. Errors as above, except that only the pages that opening reads
// are checked for damage. NOT_FOUND if there is no such file.
absl::StatusOr<std::unique_ptr<Database>> OpenStoreToRead(const std::string& path);

}  // namespace ballpiston::server
