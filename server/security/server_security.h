// The server's security: which combinations of address and credentials are safe, and the
// credentials.
//
//   unix:PATH               The kernel names the user who connects. The server's own user and root
//                           are administrators. Other users can connect if --socket-mode permits
//                           it and the access file, if there is one, lists them.
//   loopback, no TLS        Every user of this machine, with the role of --loopback-role.
//   any HOST:PORT with TLS  Clients with a credential in the access file. Without an access file,
//                           which is permitted on the loopback only, every client.
//
// The server refuses to start with any other combination: an address that other machines reach
// needs TLS and an access file; tokens need TLS.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grpcpp/security/server_credentials.h"
#include "server/listen_address.h"
#include "server/security/authenticator.h"
#include "server/security/principal.h"
#include "server/security/server_tls.h"
#include "server/security/socket_access.h"

namespace ballpiston::server {

// The paths that the flags --access-file, --tls-certificate, --tls-key and --tls-client-ca give;
// empty if a flag is absent.
struct SecurityOptions {
  std::string access_file = {};
  std::string tls_certificate = {};
  std::string tls_key = {};
  std::string tls_client_ca = {};
  // The values of --socket-mode, --socket-group and --loopback-role; empty if a flag is absent.
  std::optional<mode_t> socket_mode = {};
  std::string socket_group = {};
  std::optional<Role> loopback_role = {};
};

// The role of the principal `local` over the loopback, unless a flag says otherwise.
inline constexpr Role kLoopbackRole = Role::kSubmit;

// INVALID_ARGUMENT says which flags are missing or contradict each other, and why. Reads no file.
absl::Status CheckCombination(const SecurityOptions& options, const ListenAddress& address);

inline constexpr absl::Duration kExpiryWarning = absl::Hours(14 * 24);

class ServerSecurity {
 public:
  // Reads all files. Logs a warning if the certificate expires within kExpiryWarning or is not
  // valid now; the server starts with such a certificate. INVALID_ARGUMENT names the flag, the file
  // and the permitted values.
  static absl::StatusOr<std::unique_ptr<ServerSecurity>> Create(const SecurityOptions& options,
                                                                const ListenAddress& address);

  // Valid as long as this object.
  const Authenticator& authenticator() const { return authenticator_; }

  // For gRPC's port. This object must outlive the server that uses the credentials.
  std::shared_ptr<grpc::ServerCredentials> Credentials() const;

  // For a Unix socket.
  const SocketAccess& socket_access() const { return socket_access_; }

  // Reads the files again, and logs the same warnings as Create. If a file is invalid, its previous
  // content stays in use, and the error names the file. The new access file applies from the next
  // call on. New connections use the new certificates a second later. One thread at a time.
  absl::Status Reload();

  // The present settings, for the log.
  std::string Description() const;

  // When the server's certificate expires; empty without TLS. Any thread.
  std::optional<absl::Time> CertificateExpiry() const;

 private:
  void WarnOfExpiry() const;
  ServerSecurity(const SecurityOptions& options, const SocketAccess& socket_access,
                 const ListenAddress& address, std::shared_ptr<const AccessList> list,
                 std::unique_ptr<ServerTls> tls);

  const SecurityOptions options_;
  const SocketAccess socket_access_;
  const std::optional<Role> role_of_everybody_;  // empty: callers are authenticated
  size_t entries_;                               // of the access file
  Authenticator authenticator_;
  std::unique_ptr<ServerTls> tls_;  // null: without TLS
};

}  // namespace ballpiston::server
