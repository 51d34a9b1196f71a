// Data files that are installed with this program.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "client/library/child_process.h"

namespace ballpiston::client {

// share/ballpiston/NAME beside this program's folder.
inline std::filesystem::path InstalledFolder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(ProgramBeside("")).parent_path();
  return folder.parent_path() / "share" / "ballpiston" / name;
}

// Empty if the file cannot be read.
inline std::string Contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace ballpiston::client
