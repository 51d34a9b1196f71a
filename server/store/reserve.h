// Space on the disk that is kept for the deletion of jobs. On a full disk even a deletion needs
// some room in the log before it can free any.
//
// It is a file of zeros beside the store: a database with one large value, so that it is written
// like the store. Errors are not reported: without the reserve the store works, but a deletion on a
// full disk may fail.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

namespace ballpiston::server {

class Reserve {
 public:
  // `vfs` is as in Database::Open. The constructor does not write the file.
  Reserve(const std::string& store, size_t bytes, std::string vfs)
      : path_(store + "-reserve"), bytes_(bytes), vfs_(std::move(vfs)) {}

  bool held() const { return held_; }
  void Take();     // writes the file, if there is room
  void Release();  // removes it

 private:
  const std::string path_;
  const size_t bytes_;
  const std::string vfs_;
  bool held_ = false;
};

}  // namespace ballpiston::server
