// The part of a text file between two lines of their own, <!-- NAME:begin --> and <!-- NAME:end
// -->.
#ifndef BALLPISTON_TESTS_STABILITY_MARKED_SECTION_H_
#define BALLPISTON_TESTS_STABILITY_MARKED_SECTION_H_

#include <string>

#include "absl/status/status.h"

namespace ballpiston::stability {

// Replaces what is between the markers. NOT_FOUND if the file cannot be read or lacks one of them;
// INTERNAL if it cannot be written.
absl::Status ReplaceMarkedSection(const std::string& path, const std::string& name,
                                  const std::string& text);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TESTS_STABILITY_MARKED_SECTION_H_
