// How a channel proves who the server is, and who calls.
//
//   nothing set      no encryption: a Unix socket, a server on this machine, or a tunnel to one
//   tls              TLS; the authorities of this system vouch for the server
//   ca               TLS; the authorities in this file do
//   certificate/key  TLS, and the client shows a certificate of its own
//   token            sent with every call; over TLS only
#ifndef BALLPISTON_CLIENT_LIBRARY_CHANNEL_SECURITY_H_
#define BALLPISTON_CLIENT_LIBRARY_CHANNEL_SECURITY_H_

#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

struct ChannelSecurity {
  bool tls = false;
  std::string ca = {};           // PEM file
  std::string certificate = {};  // PEM file, with
  std::string key = {};          // PEM file, which only its owner may read
  std::string token_file = {};   // likewise; what it holds, without the end of the line
  std::string token = {};        // in place of a file

  bool HasTls() const { return tls || !ca.empty() || !certificate.empty() || !key.empty(); }
  bool HasToken() const { return !token_file.empty() || !token.empty(); }
};

// Whether these go together, and with the address; reads no file. INVALID_ARGUMENT names what is
// wrong, as a token that would travel readable for others.
absl::Status CheckSecurity(const ChannelSecurity& security, absl::string_view address);

// Reads the files. INVALID_ARGUMENT names the one that cannot be used, PERMISSION_DENIED one that
// others may read; neither shows what it holds.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> CredentialsOf(
    const ChannelSecurity& security);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_CHANNEL_SECURITY_H_
