// A folder that a death test shares with the process that it starts. The started process runs main
// from the beginning (test_main.cc), so a TemporaryFolder would be another folder there.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"

namespace ballpiston {

class DeathTestFolder {
 public:
  // Empty at first.
  DeathTestFolder() {
    const std::string own = absl::StrCat(testing::TempDir(), "ballpiston-death-test-", getpid());
    setenv(kVariable, own.c_str(), /*overwrite=*/0);  // the started process inherits it
    path_ = std::getenv(kVariable);
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~DeathTestFolder() { std::filesystem::remove_all(path_); }
  DeathTestFolder(const DeathTestFolder&) = delete;
  DeathTestFolder& operator=(const DeathTestFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  static constexpr char kVariable[] = "BALLPISTON_DEATH_TEST_FOLDER";
  std::string path_;
};

}  // namespace ballpiston
