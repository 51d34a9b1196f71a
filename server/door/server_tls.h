// The server's side of TLS (1.2 or later). Certificates can be exchanged while the server runs.
//
// gRPC's certificate provider checks a file for changes every second. It does not test the file,
// and while the operator copies a new pair it would take a key and a certificate of different
// pairs. So it reads a file in memory here, which has a pair that was tested before. A new
// connection gets the old pair or the new one, and existing connections are not affected.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grpcpp/security/server_credentials.h"
#include "server/door/private_file.h"

namespace ballpiston::server {

struct TlsFiles {
  NamedFile certificate;  // PEM: the server's certificate, then the intermediate ones
  NamedFile key;          // PEM, without a passphrase; private
};

class ServerTls {
 public:
  // INVALID_ARGUMENT names the flag, the file and the problem: cannot be read, readable by other
  // users (the key), not PEM, key and certificate of different pairs, too weak. An expired
  // certificate is accepted, because the clock may not be set yet: clients refuse it in each
  // handshake.
  static absl::StatusOr<std::unique_ptr<ServerTls>> Create(TlsFiles files);
  ServerTls(const ServerTls&) = delete;
  ServerTls& operator=(const ServerTls&) = delete;
  ~ServerTls();

  // This object must outlive the server that uses the credentials.
  std::shared_ptr<grpc::ServerCredentials> Credentials() const;

  // Reads the files again. On any error the old pair stays in use. An expired pair does not
  // replace a valid one.
  // New connections use the new pair a second later. One thread at a time.
  absl::Status Reload();

  // When the certificate in use expires. Any thread.
  absl::Time expires() const { return absl::FromUnixSeconds(expires_); }

 private:
  explicit ServerTls(TlsFiles files) : files_(std::move(files)) {}

  std::string PathInMemory() const;
  absl::Status Exchange(const std::string& content);

  const TlsFiles files_;
  // The file that gRPC reads. It has no name, so the private key never reaches a disk.
  int descriptor_ = -1;
  time_t changed_ = 0;
  std::atomic<int64_t> expires_ = 0;  // seconds since 1970, the precision of certificates
};

}  // namespace ballpiston::server
