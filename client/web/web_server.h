// The HTTP server of `ballpiston web`, for local connections: the files of the page, and a
// gateway that forwards calls in the Connect protocol to ballpistond.
//
//   GET  /                                 the page
//   POST /ballpiston.v1.SERVICE/METHOD     a call, with the token (page_access.h)
//
// Each open stream uses one of kMostConnections threads. If its reader disconnects, the call ends
// at the next message. A watch sends heartbeats, so that there is always a next message.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "client/web/json_call.h"
#include "client/web/page_files.h"

namespace ballpiston::client {

inline constexpr int kMostConnections = 32;
inline constexpr size_t kMostRequestBytes = 4 << 20;  // the same as gRPC's default limit

class WebServer {
 public:
  using Call = std::function<absl::Status(const JsonCall&, const JsonReceiver&)>;

  // Several threads may use `call` at the same time.
  WebServer(PageFiles files, Call call);
  ~WebServer();

  // `port` 0 chooses a free port. UNAVAILABLE if the port is not free.
  absl::Status Bind(int port);
  // The page's address with its token. Call it after Bind.
  std::string Url() const;
  void Serve();  // returns only when the program ends

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace ballpiston::client
