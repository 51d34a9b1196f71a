#include "client/output/standard_output.h"

#include <unistd.h>

#include <cerrno>

namespace ballpiston::client {

FileDescriptorBuffer::FileDescriptorBuffer(int descriptor) : descriptor_(descriptor) {
  setp(buffer_.data(), buffer_.data() + buffer_.size());
}

FileDescriptorBuffer::int_type FileDescriptorBuffer::overflow(int_type c) {
  if (sync() != 0) return traits_type::eof();
  if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
  return traits_type::not_eof(c);
}

int FileDescriptorBuffer::sync() {
  const char* position = pbase();
  while (error_ == 0 && position < pptr()) {
    const ssize_t written = write(descriptor_, position, static_cast<size_t>(pptr() - position));
    if (written >= 0) position += written;
    if (written < 0 && errno != EINTR) error_ = errno;
  }
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  return error_ == 0 ? 0 : -1;
}

StandardOutput::StandardOutput(int descriptor) : std::ostream(nullptr), buffer_(descriptor) {
  rdbuf(&buffer_);
}

absl::Status StandardOutput::Finish() {
  flush();
  if (buffer_.error() == 0 || buffer_.error() == EPIPE) return absl::OkStatus();
  return absl::ErrnoToStatus(buffer_.error(), "cannot write standard output");
}

}  // namespace ballpiston::client
