// The credentials of a small laboratory, for a server behind TLS: alice, who submits jobs and has a
// second token that may only read; bob, who submits too; ops, an administrator.
//
//   LaboratoryFiles files;
//   RunningServer server(Secure(files));
//   TestClient alice(server.NewChannel(files.Credentials(kAlice)));
#pragma once

#include <openssl/bio.h>
#include <openssl/ssl.h>

#include "server/door/access_list.h"
#include "server/sha256.h"
#include "tests/credentials/test_authority.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {

inline constexpr char kAlice[] = "token-of-alice-0123456789";
inline constexpr char kAliceReads[] = "token-of-alice-that-reads";
inline constexpr char kAliceOnce[] = "token-of-alice-that-expired";
inline constexpr char kBob[] = "token-of-bob-0123456789";
inline constexpr char kOps[] = "token-of-ops-0123456789";

// A line of an access file for one token, and the lines of all five tokens.
inline std::string TokenLine(const std::string& token, const Principal& principal,
                             absl::Time expires = absl::InfiniteFuture()) {
  return FormatAccessEntry({Sha256(token), principal, expires}) + "\n";
}
inline std::string LaboratoryTokens() {
  const absl::Time past = absl::FromUnixSeconds(1'000'000'000);
  return TokenLine(kAlice, {"alice", Role::kSubmit}) +
         TokenLine(kAliceReads, {"alice", Role::kRead}) +
         TokenLine(kAliceOnce, {"alice", Role::kAdmin}, past) +
         TokenLine(kBob, {"bob", Role::kSubmit}) + TokenLine(kOps, {"ops", Role::kAdmin});
}

// A folder with an access file of these tokens, and certificates of an authority of its own.
class LaboratoryFiles {
 public:
  LaboratoryFiles() {
    WriteAccessFile(LaboratoryTokens());
    WriteCertificate(authority_.Issue("server-1"));
  }

  const DoorOptions& options() const { return options_; }
  const TestAuthority& authority() const { return authority_; }

  // A file of mode 0600.
  std::string Write(const std::string& name, const std::string& text) const {
    const std::string path = folder_.File(name);
    WriteFile(path, text);
    chmod(path.c_str(), 0600);
    return path;
  }
  void WriteAccessFile(const std::string& text) const { Write("access", text); }
  void WriteCertificate(const KeyAndCertificate& made) const {
    Write("server.pem", made.certificate);
    Write("server.key", made.key);
  }

  // The credentials of a client that trusts the laboratory's authority and sends the token with
  // each call. If `token` is empty, the client sends none.
  std::shared_ptr<grpc::ChannelCredentials> Credentials(const std::string& token = "") const {
    grpc::SslCredentialsOptions trusted;
    trusted.pem_root_certs = authority_.Pem();
    const auto tls = grpc::SslCredentials(trusted);
    if (token.empty()) return tls;
    return grpc::CompositeChannelCredentials(tls, grpc::AccessTokenCredentials(token));
  }

 private:
  const TemporaryFolder folder_;
  const TestAuthority authority_{"the laboratory's authority"};
  const DoorOptions options_ = {.access_file = folder_.File("access"),
                                .tls_certificate = folder_.File("server.pem"),
                                .tls_key = folder_.File("server.key")};
};

// These options with the laboratory's TLS, at any free port of this machine. The client of the
// RunningServer sends no token, unless the options have credentials.
inline TestServerOptions Secure(const LaboratoryFiles& files, TestServerOptions options = {}) {
  if (options.listen.empty()) options.listen = "127.0.0.1:0";
  options.door = files.options();
  if (options.credentials == nullptr) options.credentials = files.Credentials();
  return options;
}

// A client that completes the TLS handshake and then sends nothing.
class SilentTlsConnection {
 public:
  explicit SilentTlsConnection(const std::string& address)
      : context_(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free),
        connection_(BIO_new_ssl_connect(context_.get()), &BIO_free_all) {
    BIO_set_conn_hostname(connection_.get(), address.c_str());
    SSL* ssl = nullptr;
    BIO_get_ssl(connection_.get(), &ssl);
    const unsigned char alpn[] = "\x02h2";
    SSL_set_alpn_protos(ssl, alpn, 3);
    SSL_set_quiet_shutdown(ssl, 1);  // a farewell to a server that is gone would raise SIGPIPE
    if (BIO_do_connect(connection_.get()) != 1) return;
    const std::unique_ptr<X509, void (*)(X509*)> shown(SSL_get1_peer_certificate(ssl), &X509_free);
    char name[256] = "";
    X509_NAME_get_text_by_NID(X509_get_subject_name(shown.get()), NID_commonName, name,
                              sizeof(name));
    served_common_name_ = name;
  }

  // The common name in the server's certificate; empty if the handshake failed.
  const std::string& served_common_name() const { return served_common_name_; }

 private:
  const std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context_;
  const std::unique_ptr<BIO, void (*)(BIO*)> connection_;
  std::string served_common_name_;
};

}  // namespace ballpiston::server
