// A file that appears whole: a reader never sees half of it, and a failure keeps the file that was
// there. A pipe or a device is written to directly.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>

#include "absl/status/status.h"
#include "client/output/standard_output.h"

namespace ballpiston::client {

// OK if a file can be created there, as far as that can be seen without creating it. Errors are
// those of NewFile::Keep.
absl::Status CheckNewFile(const std::string& flag, const std::string& path);

// Deletes the temporary files of every NewFile that is not kept, for a program that ends without
// destructors. No other thread can make or keep a file afterwards.
void RemoveUnfinishedFiles();

class NewFile {
 public:
  // `flag` is the flag that named the path, for messages.
  NewFile(std::string flag, std::string path);
  ~NewFile();  // without Keep the file does not appear
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  std::ostream& out() { return out_; }

  // The file until Keep. Empty for a pipe or a device.
  const std::filesystem::path& part() const { return part_; }

  // Everything is in the file. INVALID_ARGUMENT with flag, path and reason if the file cannot be
  // written, for instance because the disk is full.
  absl::Status Flush();
  // Once, after everything is written. Errors as Flush.
  absl::Status Keep();

 private:
  int Open();

  const std::string flag_, path_;
  std::filesystem::path file_;  // `path_` without symbolic links
  std::filesystem::path part_;  // hidden beside it, until Keep
  int descriptor_;
  int open_error_ = 0;  // errno
  FileDescriptorBuffer buffer_;
  std::ostream out_{nullptr};
};

}  // namespace ballpiston::client
