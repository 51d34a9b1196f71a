// A text file that is written as a whole: first beside its place, under another name, then renamed.
// A reader, or a run that is cut short, finds the old file or the new one, never a part of one.
#ifndef BALLPISTON_TOOLS_STABILITY_OUTPUT_FILE_H_
#define BALLPISTON_TOOLS_STABILITY_OUTPUT_FILE_H_

#include <string>

#include "absl/status/status.h"

namespace ballpiston::stability {

// Whether WriteWholeFile can write there now: OK, or the error that it would return. Creates an
// empty file in the folder and removes it.
absl::Status CheckWritable(const std::string& path);

// A new file, or one in the place of an old one, whose permissions it gets. If `path` is a symbolic
// link, it stays, and the file that it points to is replaced. On an error, which names the path,
// the old file is as it was.
absl::Status WriteWholeFile(const std::string& path, const std::string& text);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_OUTPUT_FILE_H_
