// Reads and writes whole files, and lists the files of a folder.
#ifndef BALLPISTON_TESTS_TOOLS_STABILITY_TEXT_FILE_H_
#define BALLPISTON_TESTS_TOOLS_STABILITY_TEXT_FILE_H_

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace ballpiston::stability {

inline std::string ReadText(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void WriteText(const std::string& path, const std::string& text) {
  std::ofstream(path) << text;
}

inline std::vector<std::string> NamesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  return names;
}

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TESTS_TOOLS_STABILITY_TEXT_FILE_H_
