#include "client/command/text_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::client {
namespace {

// Throws no exception if a read fails; stream iterators could.
std::string ReadAll(std::istream& in) {
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

absl::StatusOr<TextFile> ReadTextFile(const std::string& flag, const std::string& path) {
  if (path == "-") return TextFile{"standard input", ReadAll(std::cin)};
  std::ifstream in(path);
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  if (in && !is_folder) return TextFile{path, ReadAll(in)};
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " ", path, ": ", is_folder ? "is a folder" : std::strerror(errno)));
}

}  // namespace ballpiston::client
