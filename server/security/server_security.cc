#include "server/security/server_security.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "server/observability/log.h"
#include "server/security/other_services_check.h"

namespace ballpiston::server {
namespace {

absl::Status Refused(const std::string& why) { return absl::InvalidArgumentError(why); }

bool HasTls(const SecurityOptions& options) {
  return !options.tls_certificate.empty() || !options.tls_key.empty();
}

// The flags among these that are given.
std::vector<std::string> Given(const SecurityOptions& options) {
  std::vector<std::string> given;
  if (!options.access_file.empty()) given.push_back("--access-file");
  if (!options.tls_certificate.empty()) given.push_back("--tls-certificate");
  if (!options.tls_key.empty()) given.push_back("--tls-key");
  if (!options.tls_client_ca.empty()) given.push_back("--tls-client-ca");
  return given;
}

absl::Status CheckSocket(const SecurityOptions& options, const ListenAddress& address) {
  const std::vector<std::string> given = Given(options);
  if (given.empty()) return absl::OkStatus();
  return Refused(absl::StrCat("--listen=", address.Text(),
                              ": over a Unix socket only this server's user and root can connect, "
                              "both as administrators; it cannot be combined with ",
                              absl::StrJoin(given, ", ")));
}

absl::Status CheckReachable(const SecurityOptions& options, const ListenAddress& address) {
  std::vector<std::string> missing;
  if (!HasTls(options)) missing.push_back("--tls-certificate and --tls-key");
  if (options.access_file.empty()) missing.push_back("--access-file");
  if (missing.empty()) return absl::OkStatus();
  return Refused(absl::StrCat("--listen=", address.Text(),
                              ": other machines can reach this address, so it needs TLS and "
                              "credentials; missing: ",
                              absl::StrJoin(missing, " and "),
                              " (or listen on a loopback address or a Unix socket)"));
}

NamedFile AccessFile(const SecurityOptions& options) {
  return {"access-file", options.access_file};
}

// No list without an access file.
absl::StatusOr<std::shared_ptr<const AccessList>> ReadList(const SecurityOptions& options) {
  if (options.access_file.empty()) return nullptr;
  absl::StatusOr<AccessList> list = AccessList::Read(AccessFile(options));
  if (!list.ok()) return list.status();
  if (list->has_certificates() && options.tls_client_ca.empty()) {
    return Refused(absl::StrCat(AccessFile(options).Text(),
                                ": has certificates; these need --tls-client-ca, the "
                                "authorities that sign them"));
  }
  return std::make_shared<const AccessList>(*std::move(list));
}

absl::StatusOr<std::unique_ptr<ServerTls>> ReadTls(const SecurityOptions& options) {
  if (!HasTls(options)) return nullptr;
  return ServerTls::Create({{"tls-certificate", options.tls_certificate},
                            {"tls-key", options.tls_key},
                            {"tls-client-ca", options.tls_client_ca}});
}

}  // namespace

absl::Status CheckCombination(const SecurityOptions& options, const ListenAddress& address) {
  if (!address.socket_path.empty()) return CheckSocket(options, address);
  if (options.tls_certificate.empty() != options.tls_key.empty()) {
    return Refused("--tls-certificate and --tls-key: give both or neither");
  }
  if (!address.IsLoopback()) {
    if (absl::Status status = CheckReachable(options, address); !status.ok()) return status;
  }
  if (!options.access_file.empty() && !HasTls(options)) {
    return Refused(
        "--access-file needs --tls-certificate and --tls-key: without TLS, others could read the "
        "tokens");
  }
  if (!options.tls_client_ca.empty() && (!HasTls(options) || options.access_file.empty())) {
    return Refused(
        "--tls-client-ca needs --tls-certificate and --tls-key, and --access-file, which "
        "says who the holder of a certificate is");
  }
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<ServerSecurity>> ServerSecurity::Create(
    const SecurityOptions& options, const ListenAddress& address) {
  if (absl::Status status = CheckCombination(options, address); !status.ok()) return status;
  auto list = ReadList(options);
  if (!list.ok()) return list.status();
  auto tls = ReadTls(options);
  if (!tls.ok()) return tls.status();
  auto security = absl::WrapUnique(new ServerSecurity(options, *std::move(list), *std::move(tls)));
  security->WarnOfExpiry();
  return security;
}

ServerSecurity::ServerSecurity(const SecurityOptions& options,
                               std::shared_ptr<const AccessList> list,
                               std::unique_ptr<ServerTls> tls)
    : options_(options),
      entries_(list == nullptr ? 0 : list->size()),
      authenticator_(std::move(list)),
      tls_(std::move(tls)) {}

std::shared_ptr<grpc::ServerCredentials> ServerSecurity::Credentials() const {
  if (tls_ == nullptr) return grpc::InsecureServerCredentials();
  auto credentials = tls_->Credentials();
  credentials->SetAuthMetadataProcessor(std::make_shared<OtherServicesCheck>(authenticator_));
  return credentials;
}

absl::Status ServerSecurity::Reload() {
  std::vector<std::string> errors;
  const auto list = ReadList(options_);
  if (!list.ok()) {
    errors.emplace_back(list.status().message());
  } else if (*list != nullptr) {
    entries_ = (*list)->size();
    authenticator_.Replace(*list);
  }
  const absl::Status certificates = tls_ == nullptr ? absl::OkStatus() : tls_->Reload();
  if (!certificates.ok()) errors.emplace_back(certificates.message());
  WarnOfExpiry();
  return errors.empty() ? absl::OkStatus() : Refused(absl::StrJoin(errors, "; "));
}

std::optional<absl::Time> ServerSecurity::CertificateExpiry() const {
  if (tls_ == nullptr) return std::nullopt;
  return tls_->expires();
}

void ServerSecurity::WarnOfExpiry() const {
  if (tls_ == nullptr || tls_->expires() > absl::Now() + kExpiryWarning) return;
  Log(Severity::kWarning,
      absl::StrCat("the certificate in --tls-certificate=", options_.tls_certificate,
                   " is valid until ",
                   absl::FormatTime("%Y-%m-%d %H:%M UTC", tls_->expires(), absl::UTCTimeZone()),
                   " only: get a new one, and send SIGHUP"));
}

std::string ServerSecurity::Description() const {
  if (tls_ == nullptr) return "no credentials wanted";
  const std::string certificate =
      absl::StrCat("TLS, certificate valid until ",
                   absl::FormatTime("%Y-%m-%d", tls_->expires(), absl::UTCTimeZone()));
  if (options_.access_file.empty()) return absl::StrCat(certificate, ", no credentials wanted");
  return absl::StrCat(certificate, ", ", entries_, " entries in ", AccessFile(options_).Text());
}

}  // namespace ballpiston::server
