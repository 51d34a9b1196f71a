// The part of a text file between the lines <!-- NAME:begin --> and <!-- NAME:end -->.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace ballpiston::stability {

// OK if the file has this section and can be written; otherwise the error that ReplaceMarkedSection
// would return.
absl::Status CheckMarkedSection(const std::string& path, const std::string& name);

// Replaces the text between the markers. The file is written as a whole (output_file.h). NOT_FOUND
// if the file cannot be read or lacks one of the markers.
absl::Status ReplaceMarkedSection(const std::string& path, const std::string& name,
                                  const std::string& text);

}  // namespace ballpiston::stability
