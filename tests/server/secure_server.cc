#include "tests/server/secure_server.h"

#include "server/door/access_list.h"
#include "server/sha256.h"

namespace ballpiston::server {

std::string TokenLine(const std::string& token, const Principal& principal, absl::Time expires) {
  return FormatAccessEntry({Sha256(token), principal, expires}) + "\n";
}

std::string LaboratoryTokens() {
  const absl::Time past = absl::FromUnixSeconds(1'000'000'000);
  return TokenLine(kAlice, {"alice", Role::kSubmit}) +
         TokenLine(kAliceReads, {"alice", Role::kRead}) +
         TokenLine(kAliceOnce, {"alice", Role::kAdmin}, past) +
         TokenLine(kBob, {"bob", Role::kSubmit}) + TokenLine(kOps, {"ops", Role::kAdmin});
}

// ---- LaboratoryFiles ----

LaboratoryFiles::LaboratoryFiles() {
  WriteAccessFile(LaboratoryTokens());
  WriteCertificate(authority_.Issue("server-1"));
}

std::string LaboratoryFiles::Write(const std::string& name, const std::string& text) const {
  const std::string path = folder_.File(name);
  WriteFile(path, text);
  chmod(path.c_str(), 0600);
  return path;
}

void LaboratoryFiles::WriteCertificate(const KeyAndCertificate& made) const {
  Write("server.pem", made.certificate);
  Write("server.key", made.key);
}

std::shared_ptr<grpc::ChannelCredentials> LaboratoryFiles::Credentials(
    const std::string& token) const {
  grpc::SslCredentialsOptions trusted;
  trusted.pem_root_certs = authority_.Pem();
  const auto tls = grpc::SslCredentials(trusted);
  if (token.empty()) return tls;
  return grpc::CompositeChannelCredentials(tls, grpc::AccessTokenCredentials(token));
}

TestServerOptions Secure(const LaboratoryFiles& files, TestServerOptions options) {
  if (options.listen.empty()) options.listen = "127.0.0.1:0";
  options.door = files.options();
  if (options.credentials == nullptr) options.credentials = files.Credentials();
  return options;
}

// ---- SilentTlsConnection ----

SilentTlsConnection::SilentTlsConnection(const std::string& address)
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
  X509_NAME_get_text_by_NID(X509_get_subject_name(shown.get()), NID_commonName, name, sizeof(name));
  served_common_name_ = name;
}

}  // namespace ballpiston::server
