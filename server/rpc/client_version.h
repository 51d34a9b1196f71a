// Which clients this server serves. Versions are semantic: clients and servers of one major version
// understand each other, and before 1.0.0 those of one minor version.
//
// The project's clients send their version at the start of the user agent: "ballpiston/0.1.0 ...".
// A client that sends none, such as one made from the protos, is served: the name of the proto
// package, ballpiston.v1, is its version.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

// Whether this server, of version `server`, serves a client with this user agent.
//   FAILED_PRECONDITION  CLIENT_VERSION_NOT_SERVED: names both versions and what to install
absl::Status CheckClientVersion(absl::string_view user_agent, absl::string_view server);

}  // namespace ballpiston::server
