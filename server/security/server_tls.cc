#include "server/security/server_tls.h"

#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpcpp/security/tls_certificate_provider.h"
#include "grpcpp/security/tls_credentials_options.h"

namespace ballpiston::server {
namespace {

constexpr unsigned kLookSeconds = 1;

}  // namespace

absl::StatusOr<std::unique_ptr<ServerTls>> ServerTls::Create(TlsFiles files) {
  auto tls = absl::WrapUnique(new ServerTls(std::move(files)));
  const absl::StatusOr<TlsIdentity> identity = ReadTlsIdentity(tls->files_);
  if (!identity.ok()) return identity.status();
  const absl::Status loaded = tls->Load(*identity);
  if (!loaded.ok()) return loaded;
  return tls;
}

absl::Status ServerTls::Reload() {
  const absl::StatusOr<TlsIdentity> identity = ReadTlsIdentity(files_);
  if (!identity.ok()) return identity.status();
  const absl::Time now = absl::Now();
  const bool is_valid = identity->begins <= now && now < identity->expires;
  if (is_valid || !IsValidAt(now)) return Load(*identity);
  return Unusable(files_.certificate,
                  absl::StrCat("the certificate is valid from ", absl::FormatTime(identity->begins),
                               " to ", absl::FormatTime(identity->expires), " only"));
}

absl::Status ServerTls::Load(const TlsIdentity& identity) {
  auto certificate_and_key = certificate_and_key_.Prepare(identity.certificate_and_key);
  if (!certificate_and_key.ok()) return certificate_and_key.status();
  auto client_ca = client_ca_.Prepare(identity.client_ca);  // empty: gRPC does not read it
  if (!client_ca.ok()) return client_ca.status();
  certificate_and_key_.Exchange(*std::move(certificate_and_key));
  client_ca_.Exchange(*std::move(client_ca));
  begins_ = absl::ToUnixSeconds(identity.begins);
  expires_ = absl::ToUnixSeconds(identity.expires);
  return absl::OkStatus();
}

std::shared_ptr<grpc::ServerCredentials> ServerTls::Credentials() const {
  const bool asks_clients = !files_.client_ca.path.empty();
  const std::string path = certificate_and_key_.Path();
  grpc::experimental::TlsServerCredentialsOptions options(
      std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
          path, path, asks_clients ? client_ca_.Path() : "", kLookSeconds));
  options.watch_identity_key_cert_pairs();
  if (asks_clients) {
    options.watch_root_certs();
    options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  } else {
    options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  }
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace ballpiston::server
