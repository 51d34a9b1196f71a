// A folder that exists as long as the object, with a path short enough for a Unix socket.
#ifndef BALLPISTON_TESTS_SERVER_TEMPORARY_FOLDER_H_
#define BALLPISTON_TESTS_SERVER_TEMPORARY_FOLDER_H_

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace ballpiston::server {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "ballpiston-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
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

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_TEMPORARY_FOLDER_H_
