// Reads the server's certificate and its key, and tests them before gRPC uses them: gRPC would fail
// only when the first client connects.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/door/private_file.h"

namespace ballpiston::server {

struct TlsFiles {
  NamedFile certificate;  // PEM: the server's certificate, then the intermediate ones
  NamedFile key;          // PEM, without a passphrase; private
};

struct TlsIdentity {
  std::string certificate_and_key;  // PEM, in one file: always of the same pair
  absl::Time expires;               // of the certificate
};

// INVALID_ARGUMENT names the flag, the file and the problem: cannot be read, readable by other
// users (the key), not PEM, key and certificate of different pairs, too weak. The
// expiry is not compared with the clock, which may not be set yet.
absl::StatusOr<TlsIdentity> ReadTlsIdentity(const TlsFiles& files);

}  // namespace ballpiston::server
