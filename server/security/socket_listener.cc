#include "server/security/socket_listener.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "server/observability/log.h"
#include "server/security/peer_user.h"

namespace ballpiston::server {
namespace {

constexpr std::chrono::seconds kLogPause(10);
constexpr int kPauseMilliseconds = 1000;  // when descriptors or memory have run out
constexpr uint64_t kReserved = 32;

// Whether an error of accept concerns only this connection, which has already ended.
bool IsOfThePeer(int error) {
  switch (error) {
    case EMFILE:
    case ENFILE:
    case ENOBUFS:
    case ENOMEM:
    case EBADF:
    case EINVAL:
      return false;
    default:
      return true;
  }
}

// The kernel assigns the lowest free number, so all lower ones are in use.
bool IsInReserve(int descriptor) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return false;
  return static_cast<uint64_t>(descriptor) >= limit.rlim_cur - ReservedDescriptors(limit.rlim_cur);
}

// Disables Nagle's algorithm, because answers are whole messages. Fails for a Unix socket.
void SendAtOnce(int descriptor) {
  const int on = 1;
  setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
}

}  // namespace

uint64_t ReservedDescriptors(uint64_t limit) { return std::min(kReserved, limit / 4); }

absl::StatusOr<std::unique_ptr<SocketListener>> SocketListener::Listen(const ListenAddress& address,
                                                                       std::set<uid_t> permitted,
                                                                       const SocketAccess& access) {
  absl::StatusOr<BoundSockets> sockets = BoundSockets::Bind(address, access);
  if (!sockets.ok()) return sockets.status();
  const int stop = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (stop < 0) {
    return absl::FailedPreconditionError(absl::StrCat(
        "--listen=", address.Text(), ": cannot listen there (", std::strerror(errno), ")"));
  }
  ListenAddress chosen = address;
  chosen.port = sockets->port();
  return absl::WrapUnique(new SocketListener(
      std::move(chosen), *std::move(sockets), stop,
      access.IsOpenToOthers() ? std::nullopt : std::optional(std::move(permitted))));
}

SocketListener::SocketListener(ListenAddress address, BoundSockets sockets, int stop,
                               std::optional<std::set<uid_t>> permitted)
    : address_(std::move(address)),
      sockets_(std::move(sockets)),
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
  const uint64_t one = 1;
  // Cannot fail: the eventfd blocks only at 2^64 - 2.
  [[maybe_unused]] const ssize_t written = write(stop_, &one, sizeof(one));
  if (thread_.joinable()) thread_.join();
  sockets_.Close();
}

void SocketListener::Run(const Receive& receive) {
  std::vector<pollfd> events = {{stop_, POLLIN, 0}};
  for (const int listening : sockets_.descriptors()) events.push_back({listening, POLLIN, 0});
  while (true) {
    const bool waits_to_log = strangers_.count > 0 || over_reserve_.count > 0;
    const int timeout = waits_to_log ? static_cast<int>(1000 * kLogPause.count()) : -1;
    if (poll(events.data(), events.size(), timeout) < 0 && errno != EINTR) PauseAfter(errno);
    if (events[0].revents != 0) break;
    for (size_t i = 1; i < events.size(); ++i) {
      if (events[i].revents != 0) AcceptOne(events[i].fd, receive);
    }
    if (waits_to_log) LogClosed();
  }
  strangers_.last_logged.reset();
  over_reserve_.last_logged.reset();
  LogClosed();
}

bool SocketListener::LetsIn(std::optional<uid_t> peer) const {
  return permitted_ ? MayConnect(peer, *permitted_) : StandsForOneUser(peer);
}

void SocketListener::AcceptOne(int listening, const Receive& receive) {
  const int descriptor = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (descriptor < 0) {
    if (!IsOfThePeer(errno)) PauseAfter(errno);
    return;
  }
  const bool is_local = !address_.socket_path.empty();
  const std::optional<uid_t> peer = is_local ? PeerUser(descriptor) : std::nullopt;
  const bool is_stranger = is_local && !LetsIn(peer);
  if (!is_stranger && !IsInReserve(descriptor)) {
    SendAtOnce(descriptor);
    return receive(descriptor, peer);
  }
  close(descriptor);
  ++(is_stranger ? strangers_ : over_reserve_).count;
  if (is_stranger) last_stranger_ = peer;
  LogClosed();
}

// After an error such as no free descriptors, the connection stays in the kernel's queue and is
// accepted later.
void SocketListener::PauseAfter(int error) {
  if (failures_.Take(std::chrono::steady_clock::now())) {
    LogError(absl::StrCat(address_.Text(), ": cannot accept a connection: ", std::strerror(error)));
  }
  pollfd stop{stop_, POLLIN, 0};
  poll(&stop, 1, kPauseMilliseconds);
}

void SocketListener::LogClosed() {
  const char* const of_whom =
      permitted_ ? "of other users"
                 : "of users outside this user namespace (see PrivateUsers= of systemd)";
  LogClosed(strangers_, absl::StrCat(of_whom, " closed, the last of user ",
                                     last_stranger_ ? absl::StrCat(*last_stranger_) : "unknown"));
  LogClosed(over_reserve_,
            "closed: the process has nearly reached its limit of descriptors (RLIMIT_NOFILE, the "
            "unit's LimitNOFILE)");
}

void SocketListener::LogClosed(Closed& closed, const std::string& why) {
  const auto now = std::chrono::steady_clock::now();
  if (closed.count == 0 || (closed.last_logged && now - *closed.last_logged < kLogPause)) return;
  LogError(absl::StrCat(address_.Text(), ": ", closed.count,
                        closed.count == 1 ? " connection " : " connections ", why));
  closed.count = 0;
  closed.last_logged = now;
}

}  // namespace ballpiston::server
