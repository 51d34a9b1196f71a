// Accepts connections at a Unix socket, asks the kernel whose they are, and hands on those of
// permitted users. Others are closed before a byte of theirs is read, and logged: the first at
// once, then their number at most every ten seconds.
//
// The socket's file has mode 0600 from the moment it exists.
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

namespace ballpiston::server {

class SocketListener {
 public:
  // Takes over the descriptor, which does not block.
  using Receive = std::function<void(int descriptor)>;

  // Connections wait until Start. FAILED_PRECONDITION if one cannot listen there.
  static absl::StatusOr<std::unique_ptr<SocketListener>> Listen(const ListenAddress& address,
                                                                std::set<uid_t> permitted);
  ~SocketListener();

  void Start(Receive receive);  // which is called on a thread of this object

  // No connection comes after it returned; the socket's file is gone. Any number of times.
  void Stop();

 private:
  SocketListener(std::string path, int listening, int stop, std::set<uid_t> permitted);

  void Run(const Receive& receive);
  void AcceptOne(const Receive& receive);
  void Refuse(int descriptor, std::optional<uid_t> peer);
  void PauseAfter(int error);
  void LogRefused();

  const std::string path_;
  int listening_;
  int stop_;  // an event: readable when it is time to stop
  const std::set<uid_t> permitted_;
  int64_t refused_ = 0;  // since the last line in the log
  std::optional<uid_t> last_refused_;
  std::optional<std::chrono::steady_clock::time_point> last_logged_;
  std::thread thread_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_SOCKET_LISTENER_H_
