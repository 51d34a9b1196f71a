// The credentials of a small laboratory, for a server behind TLS: alice, who submits jobs and has a
// second token that may only read; bob, who submits too; ops, an administrator.
//
//   LaboratoryFiles files;
//   RunningServer server(Secure(files));
//   TestClient alice(server.NewChannel(files.Credentials(kAlice)));
#pragma once

#include <openssl/bio.h>
#include <openssl/ssl.h>

#include "server/door/principal.h"
#include "tests/credentials/test_authority.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {

inline constexpr char kAlice[] = "token-of-alice-0123456789";
inline constexpr char kAliceReads[] = "token-of-alice-that-reads";
inline constexpr char kAliceOnce[] = "token-of-alice-that-expired";
inline constexpr char kBob[] = "token-of-bob-0123456789";
inline constexpr char kOps[] = "token-of-ops-0123456789";

// A line of an access file for one token, and the lines of all five tokens.
std::string TokenLine(const std::string& token, const Principal& principal,
                      absl::Time expires = absl::InfiniteFuture());
std::string LaboratoryTokens();

// A folder with an access file of these tokens, and certificates of an authority of its own.
class LaboratoryFiles {
 public:
  LaboratoryFiles();

  const DoorOptions& options() const { return options_; }
  const TestAuthority& authority() const { return authority_; }

  // A file of mode 0600.
  std::string Write(const std::string& name, const std::string& text) const;
  void WriteAccessFile(const std::string& text) const { Write("access", text); }
  void WriteCertificate(const KeyAndCertificate& made) const;

  // The credentials of a client that trusts the laboratory's authority and sends the token with
  // each call. If `token` is empty, the client sends none.
  std::shared_ptr<grpc::ChannelCredentials> Credentials(const std::string& token = "") const;

 private:
  const TemporaryFolder folder_;
  const TestAuthority authority_{"the laboratory's authority"};
  const DoorOptions options_ = {.access_file = folder_.File("access"),
                                .tls_certificate = folder_.File("server.pem"),
                                .tls_key = folder_.File("server.key")};
};

// These options with the laboratory's TLS, at any free port of this machine. The client of the
// RunningServer sends no token, unless the options have credentials.
TestServerOptions Secure(const LaboratoryFiles& files, TestServerOptions options = {});

// A client that completes the TLS handshake and then sends nothing.
class SilentTlsConnection {
 public:
  explicit SilentTlsConnection(const std::string& address);

  // The common name in the server's certificate; empty if the handshake failed.
  const std::string& served_common_name() const { return served_common_name_; }

 private:
  const std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context_;
  const std::unique_ptr<BIO, void (*)(BIO*)> connection_;
  std::string served_common_name_;
};

}  // namespace ballpiston::server
