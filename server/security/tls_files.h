// A server's certificate, its key, and whom it lets sign clients' certificates: read, and tried out
// before gRPC sees them, which would fail only when the first client comes.
#ifndef BALLPISTON_SERVER_SECURITY_TLS_FILES_H_
#define BALLPISTON_SERVER_SECURITY_TLS_FILES_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/security/private_file.h"

namespace ballpiston::server {

struct TlsFiles {
  NamedFile certificate;  // PEM: the server's, then those between it and its authority
  NamedFile key;          // PEM, without a passphrase; kept from others
  NamedFile client_ca;    // PEM; empty path: clients need no certificate
};

struct TlsIdentity {
  std::string certificate_and_key;  // PEM, in one: they cannot be taken for two that do not belong
  std::string client_ca;            // PEM, or empty
  absl::Time begins;                // the certificate
  absl::Time expires;
};

// INVALID_ARGUMENT names flag and file, and one of: cannot be read, open to others (the key), no
// PEM, key and certificate do not belong together, too weak. The dates are not compared with the
// clock, which may not be set yet.
absl::StatusOr<TlsIdentity> ReadTlsIdentity(const TlsFiles& files);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_TLS_FILES_H_
