// Flushes a folder, that is the names of its files. The flush of a file does not include its name.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace ballpiston::server {

// After this, files that were created in, renamed into or removed from `folder` stay so after a
// power cut. UNAVAILABLE if the folder cannot be opened or flushed.
absl::Status SyncFolder(const std::string& folder);

// The folder of a path; "." for a bare name.
std::string FolderOf(const std::string& path);

}  // namespace ballpiston::server
