// The part of a text file between two lines of their own, <!-- NAME:begin --> and
// <!-- NAME:end -->.
#ifndef BALLPISTON_TOOLS_STABILITY_MARKED_SECTION_H_
#define BALLPISTON_TOOLS_STABILITY_MARKED_SECTION_H_

#include <string>

#include "absl/status/status.h"

namespace ballpiston::stability {

// Whether the file has such a section and can be written: OK, or the error that
// ReplaceMarkedSection would return.
absl::Status CheckMarkedSection(const std::string& path, const std::string& name);

// Replaces what is between the markers; the file is written as a whole (output_file.h). NOT_FOUND
// if it cannot be read or lacks one of the markers.
absl::Status ReplaceMarkedSection(const std::string& path, const std::string& name,
                                  const std::string& text);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_MARKED_SECTION_H_
