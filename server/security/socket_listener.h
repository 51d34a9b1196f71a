// Accepts connections at an address and passes them to a receiver.
//
// At a Unix socket it asks the kernel for the user of each connection. It closes the connections of
// users who are not permitted before it reads a byte, and passes the others on with their user. At
// both kinds of address it closes a connection that would leave the process fewer than
// ReservedDescriptors() descriptors. The store, the certificates and the metrics need these, so a
// client with many connections cannot stop the store. Closed connections are logged: the first at
// once, then their number at most every ten seconds.
//
// gRPC's own listener, even with SO_REUSEPORT off, does not report the user. It uses all
// descriptors, and stops for good at the first EMFILE. Socket activation by systemd would replace
// only bound_sockets.h, and only if systemd starts the server: a private server would still need
// that file.
#pragma once

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
  // Takes ownership of the non-blocking descriptor. `user`: only at a Unix socket.
  using Receive = std::function<void(int descriptor, std::optional<uid_t> user)>;

  // Connections wait until Start. A Unix socket accepts the users in `permitted`. If `access` opens
  // it to other users, it accepts every user who can open it and whom StandsForOneUser accepts. The
  // errors are those of BoundSockets::Bind.
  static absl::StatusOr<std::unique_ptr<SocketListener>> Listen(const ListenAddress& address,
                                                                std::set<uid_t> permitted,
                                                                const SocketAccess& access = {});
  ~SocketListener();

  // With the port in use, also if Listen got port 0.
  const ListenAddress& address() const { return address_; }

  void Start(Receive receive);  // a thread of this object calls `receive`

  // When this returns, no more connections come, and the file of a Unix socket is removed. May be
  // called more than once.
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
  int stop_;  // an eventfd: readable when the listener must stop
  const std::optional<std::set<uid_t>> permitted_;
  Closed strangers_;
  std::optional<uid_t> last_stranger_;
  Closed over_reserve_;
  LineBudget failures_{1, std::chrono::seconds(10)};
  std::thread thread_;
};

// The number of descriptors that connections may not use, if the process may have `limit`.
uint64_t ReservedDescriptors(uint64_t limit);

}  // namespace ballpiston::server
