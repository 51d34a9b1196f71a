// Flushing a folder: the names in it, which a file's own flush does not cover.
#ifndef BALLPISTON_SERVER_STORE_FOLDER_SYNC_H_
#define BALLPISTON_SERVER_STORE_FOLDER_SYNC_H_

#include <string>

#include "absl/status/status.h"

namespace ballpiston::server {

// A file created in, renamed into or removed from `folder` before is so after a power cut, too.
// UNAVAILABLE if the folder cannot be opened or flushed.
absl::Status SyncFolder(const std::string& folder);

// The folder that a path names something in: "." of a bare name.
std::string FolderOf(const std::string& path);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_FOLDER_SYNC_H_
