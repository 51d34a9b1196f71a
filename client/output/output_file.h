// Files that the program writes, its standard output included.
#pragma once

#include <array>
#include <filesystem>
#include <ostream>
#include <streambuf>
#include <string>

#include "absl/status/status.h"

namespace ballpiston::client {

// A stream to a file that stores why a write failed, which std::ofstream and std::cout do not.
// Needs SIGPIPE ignored. Not thread-safe.
class FileStream : public std::ostream {
 public:
  explicit FileStream(int descriptor) : std::ostream(nullptr), buffer_(descriptor) {
    rdbuf(&buffer_);
  }

  // Flushes. Returns errno of the first write that failed, or 0.
  int Finish();

 private:
  class Buffer : public std::streambuf {
   public:
    explicit Buffer(int descriptor);

    int error() const { return error_; }

   protected:
    int_type overflow(int_type c) override;
    int sync() override;

   private:
    const int descriptor_;
    int error_ = 0;
    std::array<char, 1 << 16> bytes_;
  };

  Buffer buffer_;
};

// OK if a file can be created there, as far as that can be seen without creating it. Errors are
// those of NewFile::Keep.
absl::Status CheckNewFile(const std::string& flag, const std::string& path);

// Deletes the temporary files of every NewFile that is not kept, for a program that ends without
// destructors. No other thread can make or keep a file afterwards.
void RemoveUnfinishedFiles();

// A file that appears whole: a reader never sees half of it, and a failure keeps the file that was
// there. A pipe or a device is written to directly.
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

  const std::string flag_;
  const std::string path_;
  std::filesystem::path file_;  // `path_` without symbolic links
  std::filesystem::path part_;  // hidden beside it, until Keep
  const int descriptor_;
  const int open_error_;  // errno, or 0
  FileStream out_;
};

}  // namespace ballpiston::client
