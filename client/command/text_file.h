// The text of a file that a flag names.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace ballpiston::client {

struct TextFile {
  std::string name;  // for messages: the path, or standard input
  std::string text;
};

// `-` is standard input. INVALID_ARGUMENT, with the flag and the file's name, if it cannot be read.
absl::StatusOr<TextFile> ReadTextFile(const std::string& flag, const std::string& path);

}  // namespace ballpiston::client
