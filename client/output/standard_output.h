// Standard output that stores why a write failed.
//
// If a reader closes the pipe (`ballpiston result JOB | head`), this is not an error; a full disk
// is an error. std::cout cannot distinguish the two afterwards.
#pragma once

#include <array>
#include <ostream>
#include <streambuf>

#include "absl/status/status.h"

namespace ballpiston::client {

// Needs SIGPIPE ignored. Not thread-safe.
class FileDescriptorBuffer : public std::streambuf {
 public:
  explicit FileDescriptorBuffer(int descriptor);

  int error() const { return error_; }  // errno of the first write that failed, or 0

 protected:
  int_type overflow(int_type c) override;
  int sync() override;

 private:
  int descriptor_;
  int error_ = 0;
  std::array<char, 1 << 16> buffer_;
};

class StandardOutput : public std::ostream {
 public:
  explicit StandardOutput(int descriptor = 1);

  // Flushes. OK also if the reader has closed the pipe.
  absl::Status Finish();

 private:
  FileDescriptorBuffer buffer_;
};

}  // namespace ballpiston::client
