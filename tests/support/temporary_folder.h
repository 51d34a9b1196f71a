// Folders that exist as long as their objects.
#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace ballpiston {

// Its path is short enough for a Unix socket in it.
class TemporaryFolder {
 public:
  // Throws std::runtime_error if no folder can be made.
  explicit TemporaryFolder(
      const std::filesystem::path& parent = std::filesystem::temp_directory_path())
      : path_(parent / "ballpiston-XXXXXX") {
    if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no folder at " + path_);
  }
  // Removes the folder and its contents.
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

// A folder that a death test shares with the process that it starts. The started process runs main
// from the beginning (test_main.cc), so a TemporaryFolder would be another folder there.
class DeathTestFolder {
 public:
  // Empty at first.
  DeathTestFolder() {
    const std::string own = std::filesystem::temp_directory_path() /
                            ("ballpiston-death-test-" + std::to_string(getpid()));
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
