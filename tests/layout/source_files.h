// The C++ files of the project.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {

// Text by path, which is relative to the project's folder.
inline std::map<std::string, std::string> SourceFiles() {
  const std::filesystem::path root = SourcePath("");
  std::map<std::string, std::string> files;
  for (const char* folder : {"core", "server", "client", "tests", "tools"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cc") continue;
      files[entry.path().lexically_relative(root)] = Contents(entry.path());
    }
  }
  return files;
}

}  // namespace ballpiston
