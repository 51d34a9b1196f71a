// The HTTP server of `ballpiston web`, for local connections: the files of the page, and a
// gateway that forwards calls in the Connect protocol to ballpistond.
//
//   GET  /                                 the page
//   POST /ballpiston.v1.SERVICE/METHOD     a call, with the token
//
// Other programs on this machine, and web pages of other sites in the user's browser, can reach the
// same port. Headers of a request are checked before its body is read:
//
//   Host           must be this page's address. This rejects a foreign name that resolves to this
//                  machine (DNS rebinding).
//   Origin         must be this page's, if the browser sends it
//   Authorization  must be Bearer TOKEN in every call to the server. The page's files contain no
//                  secrets and need no token.
//   Content-Length must be there in every call, without Content-Encoding and Transfer-Encoding, so
//                  that the size of the body is known
//
// Each connection uses one of kMostConnections threads. A stream beyond kMostStreams is refused, so
// that threads are left for other calls. If a stream's reader disconnects, the call ends at the
// next message. A watch sends heartbeats, so that there is always a next message.
#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "client/command/connection.h"
#include "client/output/page_files.h"

namespace ballpiston::client {

inline constexpr int kMostConnections = 32;
inline constexpr int kMostStreams = 24;
// JSON is two to three times longer than gRPC's message, of which the server permits 4 MiB.
inline constexpr size_t kMostRequestBytes = 16 << 20;

// Serves until the program ends. Calls `ready` with the page's address and its token once the port
// is open; `port` 0 chooses a free one. UNAVAILABLE if the port is not free.
absl::Status ServePage(const PageFiles& files, const Connection& connection, int port,
                       const std::function<void(const std::string& url)>& ready);

}  // namespace ballpiston::client
