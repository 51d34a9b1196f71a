// What stands between the network and the services: which combinations of address and credentials
// are safe, and the credentials themselves.
//
//   unix:PATH               the kernel says who connects: the server's own user and root, who are
//                           administrators; others by their name, if --socket-mode opens the
//                           socket to them, and if they are on the access file's list or there is
//                           no list
//   loopback, no TLS        whoever is on this machine, with the role of --loopback-role
//   any HOST:PORT with TLS  who is on the access file's list; everybody without one, which is for
//                           the loopback only
//
// Everything else is refused at the start: an address that other machines reach needs TLS and an
// access file; tokens need TLS.
#ifndef BALLPISTON_SERVER_SECURITY_SERVER_SECURITY_H_
#define BALLPISTON_SERVER_SECURITY_SERVER_SECURITY_H_

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

// INVALID_ARGUMENT tells which flags are missing, or do not go together, and why. Reads no file.
absl::Status CheckCombination(const SecurityOptions& options, const ListenAddress& address);

inline constexpr absl::Duration kExpiryWarning = absl::Hours(14 * 24);

class ServerSecurity {
 public:
  // Reads everything. The log warns of a certificate that ends within kExpiryWarning, and of one
  // that is not valid now. The server starts with such a certificate. INVALID_ARGUMENT names flag,
  // file and what is permitted.
  static absl::StatusOr<std::unique_ptr<ServerSecurity>> Create(const SecurityOptions& options,
                                                                const ListenAddress& address);

  // Outlives every call it is asked about.
  const Authenticator& authenticator() const { return authenticator_; }

  // For gRPC's port. The object has to outlive the server that uses them.
  std::shared_ptr<grpc::ServerCredentials> Credentials() const;

  // Of a Unix socket.
  const SocketAccess& socket_access() const { return socket_access_; }

  // Reads the files again, and warns as Create does; of what is wrong the old stays, and is named
  // in the error. The access file holds from the next call on, certificates for connections made a
  // second later. One thread at a time.
  absl::Status Reload();

  // For the log: what holds now.
  std::string Description() const;

  // Until when the server's certificate is valid; none without TLS. Any thread.
  std::optional<absl::Time> CertificateExpiry() const;

 private:
  void WarnOfExpiry() const;
  ServerSecurity(const SecurityOptions& options, const SocketAccess& socket_access,
                 const ListenAddress& address, std::shared_ptr<const AccessList> list,
                 std::unique_ptr<ServerTls> tls);

  const SecurityOptions options_;
  const SocketAccess socket_access_;
  const std::optional<Role> role_of_everybody_;  // none: callers are authenticated
  size_t entries_;                               // of the access file
  Authenticator authenticator_;
  std::unique_ptr<ServerTls> tls_;  // none: without TLS
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_SERVER_SECURITY_H_
