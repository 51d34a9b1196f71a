// Contents and mode of a file.
#ifndef BALLPISTON_TESTS_SERVER_FILES_H_
#define BALLPISTON_TESTS_SERVER_FILES_H_

#include <sys/stat.h>

#include <fstream>
#include <iterator>
#include <string>

#include "gtest/gtest.h"

namespace ballpiston::server {

inline std::string Contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The permissions and the setuid, setgid and sticky bits.
inline mode_t ModeOf(const std::string& path) {
  struct stat found {};
  EXPECT_EQ(stat(path.c_str(), &found), 0) << path;
  return found.st_mode & 07777;
}

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_FILES_H_
