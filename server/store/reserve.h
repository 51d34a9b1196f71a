// Space on the disk that is kept for the deletion of jobs. On a full disk even a deletion needs
// some room in the log before it can free any.
//
// It is a file of zeros beside the store: a database with one large value, so that it is written
// like the store. Errors are not reported: without the reserve the store works, but a deletion on a
// full disk may fail.
#pragma once

#include <cstddef>
#include <string>

namespace ballpiston::server {

class Reserve {
 public:
  // The constructor does not write the file.
  Reserve(const std::string& store, size_t bytes) : path_(store + "-reserve"), bytes_(bytes) {}

  bool held() const { return held_; }
  void Take();     // writes the file, if there is room
  void Release();  // removes it

 private:
  const std::string path_;
  const size_t bytes_;
  bool held_ = false;
};

}  // namespace ballpiston::server
