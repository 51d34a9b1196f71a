#include "server/security/socket_listener.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "server/observability/log.h"
#include "server/security/peer_user.h"

namespace ballpiston::server {
namespace {

constexpr int kWaiting = 1024;  // connections the kernel keeps for us
constexpr std::chrono::seconds kLogPause(10);
constexpr int kPauseMilliseconds = 1000;  // when descriptors or memory have run out

absl::Status CannotListen(const ListenAddress& address) {
  return absl::FailedPreconditionError(absl::StrCat("--listen=", address.Text(),
                                                    ": cannot listen there (", std::strerror(errno),
                                                    "); choose another address"));
}

bool Bind(int descriptor, const std::string& path) {
  sockaddr_un local{};
  local.sun_family = AF_UNIX;
  std::memcpy(local.sun_path, path.data(), std::min(path.size(), sizeof(local.sun_path) - 1));
  // Linux gives the file the mode that the socket has when it is bound: never open to others.
  return fchmod(descriptor, 0600) == 0 &&
         bind(descriptor, reinterpret_cast<const sockaddr*>(&local), sizeof(local)) == 0 &&
         listen(descriptor, kWaiting) == 0;
}

}  // namespace

absl::StatusOr<std::unique_ptr<SocketListener>> SocketListener::Listen(const ListenAddress& address,
                                                                       std::set<uid_t> permitted) {
  const int stop = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  const int listening = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (stop < 0 || listening < 0 || !Bind(listening, address.socket_path)) {
    const absl::Status status = CannotListen(address);
    for (const int descriptor : {stop, listening}) {
      if (descriptor >= 0) close(descriptor);
    }
    return status;
  }
  return absl::WrapUnique(
      new SocketListener(address.socket_path, listening, stop, std::move(permitted)));
}

SocketListener::SocketListener(std::string path, int listening, int stop, std::set<uid_t> permitted)
    : path_(std::move(path)),
      listening_(listening),
      stop_(stop),
      permitted_(std::move(permitted)) {}

SocketListener::~SocketListener() {
  Stop();
  close(stop_);
}

void SocketListener::Start(Receive receive) {
  thread_ = std::thread([this, receive = std::move(receive)] { Run(receive); });
}

void SocketListener::Stop() {
  if (listening_ < 0) return;
  const uint64_t one = 1;
  // Cannot fail: the event counts to 2^64 - 2 before it would block.
  [[maybe_unused]] const ssize_t written = write(stop_, &one, sizeof(one));
  if (thread_.joinable()) thread_.join();
  close(std::exchange(listening_, -1));
  unlink(path_.c_str());
}

void SocketListener::Run(const Receive& receive) {
  pollfd events[] = {{listening_, POLLIN, 0}, {stop_, POLLIN, 0}};
  while (true) {
    const bool waits_to_log = refused_ > 0;
    const int timeout = waits_to_log ? static_cast<int>(1000 * kLogPause.count()) : -1;
    if (poll(events, 2, timeout) < 0 && errno != EINTR) PauseAfter(errno);
    if (events[1].revents != 0) break;
    if (events[0].revents != 0) AcceptOne(receive);
    if (waits_to_log) LogRefused();
  }
  last_logged_.reset();
  LogRefused();
}

void SocketListener::AcceptOne(const Receive& receive) {
  const int descriptor = accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (descriptor < 0) {
    // The peer has gone again, or another reason to look anew.
    const bool passing = errno == EAGAIN || errno == EINTR || errno == ECONNABORTED;
    if (!passing) PauseAfter(errno);
    return;
  }
  const std::optional<uid_t> peer = PeerUser(descriptor);
  if (MayConnect(peer, permitted_)) return receive(descriptor);
  Refuse(descriptor, peer);
}

void SocketListener::Refuse(int descriptor, std::optional<uid_t> peer) {
  close(descriptor);
  ++refused_;
  last_refused_ = peer;
  LogRefused();
}

// Out of descriptors, say: the connection stays with the kernel and is looked at again.
void SocketListener::PauseAfter(int error) {
  LogError(absl::StrCat("unix:", path_, ": cannot accept a connection: ", std::strerror(error)));
  pollfd stop{stop_, POLLIN, 0};
  poll(&stop, 1, kPauseMilliseconds);
}

void SocketListener::LogRefused() {
  const auto now = std::chrono::steady_clock::now();
  if (refused_ == 0 || (last_logged_ && now - *last_logged_ < kLogPause)) return;
  LogError(absl::StrCat("unix:", path_, ": ", refused_,
                        refused_ == 1 ? " connection" : " connections",
                        " of other users closed, the last of user ",
                        last_refused_ ? absl::StrCat(*last_refused_) : "unknown"));
  refused_ = 0;
  last_logged_ = now;
}

}  // namespace ballpiston::server
