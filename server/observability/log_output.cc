#include "server/observability/log_output.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace ballpiston::server {
namespace {

constexpr int kPatienceMilliseconds = 100;

// Writes without waiting. A pipe does not block for the bytes that it has room for; a socket needs
// MSG_DONTWAIT.
ssize_t WriteSome(int descriptor, absl::string_view bytes) {
  const ssize_t sent = send(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent >= 0 || errno != ENOTSOCK) return sent;
  return write(descriptor, bytes.data(), bytes.size());
}

}  // namespace

void LogOutput::Write(absl::string_view line, absl::FunctionRef<std::string(int64_t lost)> loss) {
  MutexLock lock(mutex_);
  if (lost_ > 0 && Put(loss(lost_))) lost_ = 0;
  if (lost_ > 0 || !Put(line)) ++lost_;
}

bool LogOutput::Put(absl::string_view line) {
  if (torn_ && !PutWhole("\n")) return false;
  return PutWhole(line);
}

bool LogOutput::PutWhole(absl::string_view text) {
  while (!text.empty()) {
    if (!AwaitRoom()) return false;
    const ssize_t written = WriteSome(descriptor_, text);
    if (written < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<size_t>(written));
    torn_ = !text.empty();
  }
  return true;
}

bool LogOutput::AwaitRoom() {
  pollfd room{descriptor_, POLLOUT, 0};
  const int ready = poll(&room, 1, stalled_ ? 0 : kPatienceMilliseconds);
  if (ready < 0 && errno == EINTR) return AwaitRoom();
  stalled_ = ready <= 0;
  return !stalled_;
}

}  // namespace ballpiston::server
