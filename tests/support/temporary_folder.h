// A folder that exists as long as the object. Its path is short enough for a Unix socket in it.
#pragma once

#include <string>

namespace ballpiston {

class TemporaryFolder {
 public:
  TemporaryFolder();   // throws std::runtime_error if no folder can be made
  ~TemporaryFolder();  // removes the folder and its contents
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace ballpiston
