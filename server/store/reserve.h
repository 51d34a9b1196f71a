// Space on the disk that is kept for the deletion of jobs. On a full disk even a deletion needs
// some room in the log before it can free any.
//
// It is a file of zeros beside the store. Errors are not reported: without the reserve the store
// works, but a deletion on a full disk may fail.
#pragma once

#include <cstddef>
#include <string>

#include "server/store/disk_calls.h"

namespace ballpiston::server {

class Reserve {
 public:
  // `vfs` is as in Database::Open. `calls` records each disk call; it must outlive the reserve. The
  // constructor does not write the file.
  Reserve(const std::string& store, size_t bytes, std::string vfs, DiskCalls& calls);

  bool held() const { return held_; }
  void Take();     // writes the file, if there is room
  void Release();  // removes it

 private:
  const std::string path_;
  const size_t bytes_;
  const std::string vfs_;
  DiskCalls& calls_;
  bool held_ = false;
};

}  // namespace ballpiston::server
