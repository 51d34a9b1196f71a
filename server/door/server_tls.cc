#include "server/door/server_tls.h"

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
  const absl::Status published = certificate_and_key_.Publish(identity.certificate_and_key);
  if (!published.ok()) return published;
  begins_ = absl::ToUnixSeconds(identity.begins);
  expires_ = absl::ToUnixSeconds(identity.expires);
  return absl::OkStatus();
}

std::shared_ptr<grpc::ServerCredentials> ServerTls::Credentials() const {
  const std::string path = certificate_and_key_.Path();
  grpc::experimental::TlsServerCredentialsOptions options(
      std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(path, path,
                                                                           kLookSeconds));
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace ballpiston::server
