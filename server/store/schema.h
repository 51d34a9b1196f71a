// The tables of the store, and the checks of a file before it is used as a store.
//
//   jobs      one row a job; `sequence` orders them by age and names the job in the next five
//   requests  (principal, request id) -> the job that the request made
//   checkpoints  (job, point) -> storage.Checkpoint, of unfinished points of active jobs
//   chunks    (job, point, chunk) -> storage.Chunk, of chunks that wait for an earlier one
//   results   (job, point) -> v1.PointResult without its details, of finished points
//   details   (job, point) -> v1.PointResult, compressed: the details of those that have any
//   dropped   deleted and expired jobs whose results are still being removed (sweeper.h)
//   server    one row: a random name of this store, which owns its shared folder
//   pilots    the limit's error that pilot runs measured, by place and engine
//
// `application_id` marks the file as a ballpiston store; `user_version` is the version of these
// tables.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

inline constexpr int64_t kSchemaVersion = 8;
inline constexpr int64_t kApplicationId = 0x62706973;  // "bpis"

// The connection that writes and checkpoints. Checks an existing store; creates a store if there is
// none. On an error the file is unchanged:
//   FAILED_PRECONDITION  damaged, of a newer version, or of another program
//   UNAVAILABLE          its disk is full or fails, or the file is not readable
//   PERMISSION_DENIED    the file is not writable
absl::StatusOr<std::unique_ptr<Database>> OpenStoreFile(const std::string& path,
                                                        const std::string& vfs = std::string());

// A read-only connection to a store. Errors as above, except that only the pages that opening reads
// are checked for damage. NOT_FOUND if there is no such file.
absl::StatusOr<std::unique_ptr<Database>> OpenStoreToRead(const std::string& path,
                                                          const std::string& vfs = std::string());

}  // namespace ballpiston::server
