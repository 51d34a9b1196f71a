// Writes a text file atomically: writes it under another name in the same folder, then renames it.
// A reader finds the old file or the new file, never a partial file, even if the program is killed.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace ballpiston::stability {

// OK if WriteWholeFile can write there now; otherwise the error that it would return. Creates an
// empty file in the folder and removes it.
absl::Status CheckWritable(const std::string& path);

// Creates or replaces the file `path`. A file that replaces an old file gets its permissions.
// If `path` is a symbolic link, the link stays, and the file that it points to is replaced. An
// error names the path, and the old file is unchanged.
absl::Status WriteWholeFile(const std::string& path, const std::string& text);

}  // namespace ballpiston::stability
