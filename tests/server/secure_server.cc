#include "tests/server/secure_server.h"

#include <openssl/bio.h>
#include <openssl/ssl.h>
#include <sys/stat.h>

#include <fstream>

#include "grpcpp/create_channel.h"
#include "server/security/access_entry.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/running_server.h"

namespace ballpiston::server {
namespace {

std::string Line(const std::string& token, const Principal& principal,
                 absl::Time expires = absl::InfiniteFuture()) {
  return FormatAccessEntry({HashOf(token), principal, expires}) + "\n";
}

}  // namespace

LaboratoryFiles::LaboratoryFiles(bool mutual) {
  options_.access_file = Path("access");
  options_.tls_certificate = Path("server.pem");
  options_.tls_key = Path("server.key");
  if (mutual) options_.tls_client_ca = Write("clients.pem", authority_.Pem());
  WriteAccessFile(LaboratoryTokens());
  WriteCertificate(authority_.Issue("server-1"));
}

std::string LaboratoryFiles::Write(const std::string& name, const std::string& text) const {
  const std::string path = Path(name);
  std::ofstream(path) << text;
  chmod(path.c_str(), 0600);
  return path;
}

void LaboratoryFiles::WriteCertificate(const KeyAndCertificate& made) const {
  Write("server.pem", made.certificate);
  Write("server.key", made.key);
}

std::string LaboratoryTokens() {
  const absl::Time past = absl::FromUnixSeconds(1'000'000'000);
  return Line(kAlice, {"alice", Role::kSubmit}) + Line(kAliceReads, {"alice", Role::kRead}) +
         Line(kAliceOnce, {"alice", Role::kAdmin}, past) + Line(kBob, {"bob", Role::kSubmit}) +
         Line(kOps, {"ops", Role::kAdmin});
}

ServerOptions SecureOptions(const SecurityOptions& security, const std::string& data_dir) {
  ServerOptions options;
  options.data_dir = data_dir;
  options.listen = "127.0.0.1:0";
  options.security = security;
  options.factory = FakeExperiments();
  options.store.stall = kNeverStalls;
  return options;
}

std::shared_ptr<grpc::Channel> SecureChannel(const std::string& address, const std::string& ca,
                                             const KeyAndCertificate& own) {
  grpc::SslCredentialsOptions options;
  options.pem_root_certs = ca;
  options.pem_cert_chain = own.certificate;
  options.pem_private_key = own.key;
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(address, grpc::SslCredentials(options), arguments);
}

std::string ServedCommonName(const std::string& address) {
  const std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context(SSL_CTX_new(TLS_client_method()),
                                                             &SSL_CTX_free);
  const std::unique_ptr<BIO, void (*)(BIO*)> connection(BIO_new_ssl_connect(context.get()),
                                                        &BIO_free_all);
  BIO_set_conn_hostname(connection.get(), address.c_str());
  SSL* ssl = nullptr;
  BIO_get_ssl(connection.get(), &ssl);
  const unsigned char alpn[] = "\x02h2";
  SSL_set_alpn_protos(ssl, alpn, 3);
  if (BIO_do_connect(connection.get()) != 1) return "";
  const std::unique_ptr<X509, void (*)(X509*)> shown(SSL_get1_peer_certificate(ssl), &X509_free);
  char name[256] = "";
  X509_NAME_get_text_by_NID(X509_get_subject_name(shown.get()), NID_commonName, name, sizeof(name));
  return name;
}

}  // namespace ballpiston::server
