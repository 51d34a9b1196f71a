// How the client and the server authenticate each other.
//
//   nothing set      no encryption: a Unix socket, or a server on the loopback
//   tls              TLS; the system's certificate authorities verify the server
//   ca               TLS; the certificate authorities in this file verify the server
//   token            sent with every call, over TLS or to a loopback address
//
// Without TLS and without a token, the client sends to a loopback address the token of its own
// user's server, if one listens there.
#pragma once

#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

struct ChannelSecurity {
  bool tls = false;
  std::string ca = {};          // PEM file
  std::string token_file = {};  // only its owner may read it; white space around the token is cut
  std::string token = {};       // instead of a token file

  bool HasTls() const { return tls || !ca.empty(); }
  bool HasToken() const { return !token_file.empty() || !token.empty(); }
};

// The token that a server on the loopback makes for its own user at each start; empty if no server
// of this user listens at `address`. The server keeps the token in a file that only this user can
// read, whose name is the address, in a folder for each machine that shares the home folder:
//   $XDG_STATE_HOME/ballpiston/tokens/MACHINE/127.0.0.1:50051    (~/.local/state if it is not set)
std::string OwnToken(const std::string& address);

// Both functions take a loopback address as a number, 127.0.0.1:50051, and treat localhost as any
// other name. OpenChannel (channel.h) replaces localhost.
//
// Checks that the settings fit each other and the address. Reads no file. INVALID_ARGUMENT names
// the fault, e.g. a token for another machine without encryption.
absl::Status CheckSecurity(const ChannelSecurity& security, absl::string_view address);

// Reads the files. INVALID_ARGUMENT names a file that cannot be used, PERMISSION_DENIED a secret
// file that other users can read. The messages never show the contents of a file.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> CredentialsOf(
    const ChannelSecurity& security, const std::string& address);

}  // namespace ballpiston::client
