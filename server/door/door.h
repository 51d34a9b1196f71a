// The server's door: which combinations of address and credentials are safe, and the credentials.
//
//   unix:PATH               Only the server's own user, and root, can open the socket. They are the
//                           principal `local`, and need no token.
//   loopback, no TLS        Every caller needs a token: the server's own (own_token.h), which its
//                           user's clients find, or one of the access file.
//   any HOST:PORT with TLS  Every caller needs a token of the access file.
//
// The server refuses to start with any other combination. Health needs no token.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grpcpp/security/server_credentials.h"
#include "server/door/access_list.h"
#include "server/door/authenticator.h"
#include "server/door/listen_address.h"
#include "server/door/own_token.h"
#include "server/door/server_tls.h"

namespace ballpiston::server {

// The paths that the flags --access-file, --tls-certificate and --tls-key give; empty if a flag is
// absent.
struct DoorOptions {
  std::string access_file = {};
  std::string tls_certificate = {};
  std::string tls_key = {};
  std::string own_tokens = OwnToken::DefaultFolder();
};

// INVALID_ARGUMENT says which flags are needed or contradict each other, and why. Reads no file.
absl::Status CheckCombination(const DoorOptions& options, const ListenAddress& address);

inline constexpr absl::Duration kExpiryWarning = absl::Hours(14 * 24);

class Door {
 public:
  // Reads all files. Logs a warning if the certificate expires within kExpiryWarning, and an error
  // if it has expired; the server starts with such a certificate. INVALID_ARGUMENT names the flag,
  // the file and the permitted values.
  static absl::StatusOr<std::unique_ptr<Door>> Create(const DoorOptions& options,
                                                      const ListenAddress& address);

  // Valid as long as this object.
  const Authenticator& authenticator() const { return authenticator_; }

  // For gRPC's port. This object must outlive the server that uses the credentials.
  std::shared_ptr<grpc::ServerCredentials> Credentials() const;

  // Writes the own token's file, if the server listens on the loopback without TLS. Logs a warning
  // if the file cannot be written. `address` has the port in use.
  void PublishOwnToken(const ListenAddress& address);

  // Removes the own token's file.
  void Close() { own_token_.reset(); }

  // Reads the files again, and logs the same warnings as Create. If a file is invalid, its previous
  // content stays in use, and the error says which files are reloaded and which are not. The new
  // access file applies from the next call on. New connections use the new certificate a second
  // later. One thread at a time.
  absl::Status Reload();

  // The present settings, for the log.
  std::string Description() const;

  // When the server's certificate expires; empty without TLS. Any thread.
  std::optional<absl::Time> CertificateExpiry() const;

 private:
  Door(const DoorOptions& options, bool needs_tokens)
      : options_(options), needs_tokens_(needs_tokens), authenticator_(needs_tokens) {}

  absl::Status ReadAccessFile();
  void AcceptTokens();
  void WarnOfExpiry() const;

  const DoorOptions options_;
  const bool needs_tokens_;  // false at a Unix socket
  AccessList access_;        // of the access file
  Authenticator authenticator_;
  std::unique_ptr<ServerTls> tls_;     // null: without TLS
  std::optional<OwnToken> own_token_;  // on the loopback without TLS
};

}  // namespace ballpiston::server
