// The HTTP server of `ballpiston web`, for local connections: the files of the page, and a
// gateway that forwards calls in the Connect protocol to ballpistond.
//
//   GET  /                                 the page
//   POST /ballpiston.v1.SERVICE/METHOD     a call, with the token (page_access.h)
//
// Each open stream takes one of kMostConnections threads. If its reader disconnects, the call ends
// with the next message; a watch has a heartbeat at least.
#ifndef BALLPISTON_CLIENT_WEB_WEB_SERVER_H_
#define BALLPISTON_CLIENT_WEB_WEB_SERVER_H_

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "client/web/json_call.h"
#include "client/web/page_files.h"

namespace ballpiston::client {

inline constexpr int kMostConnections = 32;
inline constexpr size_t kMostRequestBytes = 4 << 20;  // as gRPC's own limit

class WebServer {
 public:
  using Call = std::function<absl::Status(const JsonCall&, const JsonReceiver&)>;

  // `call` may be called from several threads.
  WebServer(std::map<std::string, PageFile> files, Call call);
  ~WebServer();

  // `port` 0: any that is free. UNAVAILABLE if the port is not free.
  absl::Status Bind(int port);
  // The page's address with its token. After Bind.
  std::string Url() const;
  void Serve();  // until the program ends

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_WEB_WEB_SERVER_H_
