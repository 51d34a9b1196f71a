// Flushes the name of a file. The flush of a file does not include its name.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace ballpiston::server {

// After this, a file or folder that was created, renamed to or removed from `path` stays so after a
// power cut. UNAVAILABLE if the folder that has this name cannot be opened or flushed.
absl::Status SyncNameOf(const std::string& path);

}  // namespace ballpiston::server
