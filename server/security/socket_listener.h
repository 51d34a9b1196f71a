// Accepts connections at an address and hands them on.
//
// At a Unix socket it asks the kernel for the user of each connection. It closes the connections of
// users who are not permitted before it reads a byte of theirs, and hands the others on with their
// user. At either kind of address it closes a connection that would leave the process fewer than
// ReservedDescriptors(). The store, the certificates and the metrics need these: a client that
// opens connections must not keep results from the disk. Both are logged: the first at once, then
// their number at most every ten seconds.
//
// gRPC's own listener, even with SO_REUSEPORT off, does not say who connects. It uses every
// descriptor, and stops for good at the first EMFILE. Socket activation of systemd would replace
// only bound_sockets.h, and only where systemd starts the server: a private server would still need
// that file.
#ifndef BALLPISTON_SERVER_SECURITY_SOCKET_LISTENER_H_
#define BALLPISTON_SERVER_SECURITY_SOCKET_LISTENER_H_

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "server/listen_address.h"
#include "server/observability/line_budget.h"
#include "server/security/bound_sockets.h"

namespace ballpiston::server {

class SocketListener {
 public:
  // Takes over the descriptor, which does not block. `user`: only at a Unix socket.
  using Receive = std::function<void(int descriptor, std::optional<uid_t> user)>;

  // Connections wait until Start. A Unix socket lets in the users that are `permitted`, or, if
  // `access` opens it to others, every user who can open it and whom StandsForOneUser accepts.
  // Errors as BoundSockets::Bind's.
  static absl::StatusOr<std::unique_ptr<SocketListener>> Listen(const ListenAddress& address,
                                                                std::set<uid_t> permitted,
                                                                const SocketAccess& access = {});
  ~SocketListener();

  // With the port that was chosen, if any was free to be.
  const ListenAddress& address() const { return address_; }

  void Start(Receive receive);  // which is called on a thread of this object

  // No connection comes after it returned; a Unix socket's file is gone. Any number of times.
  void Stop();

 private:
  // Connections that were closed for one reason.
  struct Closed {
    int64_t count = 0;  // since the last line in the log
    std::optional<std::chrono::steady_clock::time_point> last_logged;
  };

  // `permitted` empty: every user whom StandsForOneUser accepts.
  SocketListener(ListenAddress address, BoundSockets sockets, int stop,
                 std::optional<std::set<uid_t>> permitted);

  bool LetsIn(std::optional<uid_t> peer) const;
  void Run(const Receive& receive);
  void AcceptOne(int listening, const Receive& receive);
  void PauseAfter(int error);
  void LogClosed();
  void LogClosed(Closed& closed, const std::string& why);

  const ListenAddress address_;
  BoundSockets sockets_;
  int stop_;  // an event: readable when it is time to stop
  const std::optional<std::set<uid_t>> permitted_;
  Closed strangers_;
  std::optional<uid_t> last_stranger_;
  Closed over_reserve_;
  LineBudget failures_{1, std::chrono::seconds(10)};
  std::thread thread_;
};

// Descriptors of the process that no connection may take, of `limit` in all.
uint64_t ReservedDescriptors(uint64_t limit);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_SOCKET_LISTENER_H_
