// The server's side of TLS (1.2 or later), with certificates that can be exchanged while it runs.
//
// gRPC's certificate provider looks at files every second; here these are files in memory
// (published_file.h) that hold what has been tried out before. So a connection that is being made
// sees the old pair or the new one, and connections that are there notice nothing. (gRPC has a
// certificate callback for the purpose as well, but exchanges what it returns without a lock.) If
// that provider read the operator's own files, it would accept a key that other users can read.
// While files are being copied, it would accept a key and a certificate of different pairs. It
// would take a broken file for no certificate. It looks only at the times of change, does not test
// the files, and reports nothing to the operator.
#ifndef BALLPISTON_SERVER_SECURITY_SERVER_TLS_H_
#define BALLPISTON_SERVER_SECURITY_SERVER_TLS_H_

#include <atomic>
#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grpcpp/security/server_credentials.h"
#include "server/security/published_file.h"
#include "server/security/tls_files.h"

namespace ballpiston::server {

class ServerTls {
 public:
  // Errors as ReadTlsIdentity's. A certificate that is not valid yet, or no longer, is accepted,
  // because the clock may be set some time after a boot. Clients refuse it in each handshake until
  // it is valid.
  static absl::StatusOr<std::unique_ptr<ServerTls>> Create(TlsFiles files);

  // With a client_ca: a client without a certificate that one of it signed is not let in. The
  // object has to outlive the server that uses them.
  std::shared_ptr<grpc::ServerCredentials> Credentials() const;

  // Reads the files again. What is wrong with one of them, or with the system, leaves all as they
  // were; what is right serves new connections a second later. A certificate that is not valid now
  // replaces only one that is not valid either. One thread at a time.
  absl::Status Reload();

  // The certificate in use. Any thread.
  absl::Time begins() const { return absl::FromUnixSeconds(begins_); }
  absl::Time expires() const { return absl::FromUnixSeconds(expires_); }
  bool IsValidAt(absl::Time time) const { return begins() <= time && time < expires(); }

 private:
  explicit ServerTls(TlsFiles files) : files_(std::move(files)) {}

  absl::Status Load(const TlsIdentity& identity);

  const TlsFiles files_;
  PublishedFile certificate_and_key_;
  PublishedFile client_ca_;
  std::atomic<int64_t> begins_ = 0;
  std::atomic<int64_t> expires_ = 0;  // seconds since 1970, which is all that a certificate tells
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_SERVER_TLS_H_
