// The server's side of TLS (1.2 or later). Certificates can be exchanged while the server runs.
//
// gRPC's certificate provider checks files for changes every second. Here these are files in memory
// (published_file.h), whose contents were tested before. A new connection therefore gets the old
// pair or the new one, and existing connections are not affected. (gRPC also has a certificate
// callback, but exchanges its result without a lock.) If the provider read the operator's own
// files, it would accept a key that other users can read. While files are being copied, it would
// accept a key and a certificate of different pairs. It would treat a broken file as no
// certificate. It compares only times of change, does not test the files, and reports nothing to
// the operator.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grpcpp/security/server_credentials.h"
#include "server/door/published_file.h"
#include "server/door/tls_identity.h"

namespace ballpiston::server {

class ServerTls {
 public:
  // The errors are those of ReadTlsIdentity. A certificate that is not valid yet, or no longer, is
  // accepted, because the clock may be set some time after a boot. Clients refuse it in each
  // handshake until it is valid.
  static absl::StatusOr<std::unique_ptr<ServerTls>> Create(TlsFiles files);

  // This object must outlive the server that uses the credentials.
  std::shared_ptr<grpc::ServerCredentials> Credentials() const;

  // Reads the files again. On any error all previous contents stay in use. New connections use the
  // new contents a second later. A certificate that is not valid now replaces only a certificate
  // that is not valid either. One thread at a time.
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
  std::atomic<int64_t> begins_ = 0;
  std::atomic<int64_t> expires_ = 0;  // seconds since 1970, the precision of certificates
};

}  // namespace ballpiston::server
