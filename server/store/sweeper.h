// Frees the space of the results of deleted and expired jobs: removes their rows, then shortens the
// file by its free pages. Each step is short, so that other writes need not wait long. Such a job
// is in the table `dropped` until its last row is removed, so a restart goes on with the rest.
//
// Each function runs inside the transaction of its caller, which handles errors (sqlite.h).
#pragma once

#include <cstdint>

#include "server/store/sqlite.h"

namespace ballpiston::server {

// Rows and pages that a step removes. Some milliseconds, and little room in the log.
inline constexpr int64_t kSweptRows = 64, kSweptPages = 256;
// Checkpoints that are replaced leave free pages, which the next checkpoints use.
inline constexpr int64_t kKeptPages = 256;

// False: nothing was left to do.
bool SweepStep(Database& database);

// Whether rows of deleted or expired jobs still have to be removed.
bool IsSweeping(Database& database);

// The bytes of the store's pages that are not free. The log beside the file is not counted.
int64_t UsedBytes(Database& database);

}  // namespace ballpiston::server
