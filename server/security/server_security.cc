#include "server/security/server_security.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
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

bool IsOpenSocket(const SecurityOptions& options) {
  return options.socket_mode.value_or(SocketAccess().mode) != SocketAccess().mode;
}

absl::Status CheckSocketMode(const SecurityOptions& options) {
  const bool is_of_group = options.socket_mode == mode_t{0660};
  if (is_of_group && options.socket_group.empty()) {
    return Refused("--socket-mode=0660 needs --socket-group, the group that may connect");
  }
  if (is_of_group || options.socket_group.empty()) return absl::OkStatus();
  return Refused(absl::StrCat("--socket-group=", options.socket_group,
                              " needs --socket-mode=0660, which opens the socket to the group"));
}

absl::Status CheckSocket(const SecurityOptions& options, const ListenAddress& address) {
  if (options.loopback_role) {
    return Refused(absl::StrCat(
        "--loopback-role=", RoleName(*options.loopback_role),
        " needs --listen=HOST:PORT with a loopback host, not --listen=", address.Text()));
  }
  std::vector<std::string> given = Given(options);
  const bool has_list = !options.access_file.empty();
  if (IsOpenSocket(options) && has_list) given.erase(given.begin());  // removes the access file
  if (given.empty()) return CheckSocketMode(options);
  return Refused(absl::StrCat("--listen=", address.Text(),
                              ": over a Unix socket the kernel says who connects, by default only "
                              "this server's user and root; a Unix socket cannot be combined with ",
                              absl::StrJoin(given, ", "),
                              " (an access file goes with --socket-mode=0660 or 0666)"));
}

// Rejects the flags of a Unix socket at another address.
absl::Status CheckNoSocketFlags(const SecurityOptions& options, const ListenAddress& address) {
  if (!options.socket_mode && options.socket_group.empty()) return absl::OkStatus();
  return Refused(absl::StrCat(options.socket_mode
                                  ? absl::StrFormat("--socket-mode=%04o", *options.socket_mode)
                                  : absl::StrCat("--socket-group=", options.socket_group),
                              " needs --listen=unix:PATH, not --listen=", address.Text()));
}

absl::Status CheckLoopbackRole(const SecurityOptions& options, const ListenAddress& address) {
  if (!options.loopback_role) return absl::OkStatus();
  const std::string flag = absl::StrCat("--loopback-role=", RoleName(*options.loopback_role));
  if (!address.IsLoopback()) {
    return Refused(absl::StrCat(flag, " needs a loopback host, not --listen=", address.Text()));
  }
  if (options.access_file.empty()) return absl::OkStatus();
  return Refused(absl::StrCat(flag,
                              " cannot be combined with --access-file, which gives each "
                              "credential its role"));
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

std::string DateText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d", time, absl::UTCTimeZone());
}

std::string MinuteText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d %H:%M UTC", time, absl::UTCTimeZone());
}

// Null without an access file.
absl::StatusOr<std::shared_ptr<const AccessList>> ReadList(const SecurityOptions& options) {
  if (options.access_file.empty()) return nullptr;
  absl::StatusOr<AccessList> list = AccessList::Read(AccessFile(options));
  if (!list.ok()) return list.status();
  if (IsOpenSocket(options) && (list->has_tokens() || list->has_certificates())) {
    return Refused(absl::StrCat(AccessFile(options).Text(),
                                ": has tokens or certificates; a Unix socket permits only "
                                "lines of the kind user"));
  }
  if (!IsOpenSocket(options) && list->has_users()) {
    return Refused(absl::StrCat(AccessFile(options).Text(),
                                ": has lines of the kind user; these need a Unix socket and "
                                "--socket-mode=0660 or 0666"));
  }
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

absl::StatusOr<SocketAccess> FindSocketAccess(const SecurityOptions& options) {
  SocketAccess access{.mode = options.socket_mode.value_or(SocketAccess().mode)};
  if (options.socket_group.empty()) return access;
  const absl::StatusOr<gid_t> group = FindGroup(options.socket_group);
  if (!group.ok()) return group.status();
  access.group = *group;
  return access;
}

// The role of all callers if they are not authenticated; empty if they are.
std::optional<Role> RoleOfEverybody(const SecurityOptions& options, const ListenAddress& address) {
  if (IsOpenSocket(options) || !options.access_file.empty()) return std::nullopt;
  return address.socket_path.empty() ? options.loopback_role.value_or(kLoopbackRole) : Role::kAdmin;
}

}  // namespace

absl::Status CheckCombination(const SecurityOptions& options, const ListenAddress& address) {
  if (!address.socket_path.empty()) return CheckSocket(options, address);
  for (const absl::Status& status :
       {CheckNoSocketFlags(options, address), CheckLoopbackRole(options, address)}) {
    if (!status.ok()) return status;
  }
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
  const auto socket_access = FindSocketAccess(options);
  if (!socket_access.ok()) return socket_access.status();
  auto list = ReadList(options);
  if (!list.ok()) return list.status();
  auto tls = ReadTls(options);
  if (!tls.ok()) return tls.status();
  auto security = absl::WrapUnique(
      new ServerSecurity(options, *socket_access, address, *std::move(list), *std::move(tls)));
  security->WarnOfExpiry();
  return security;
}

ServerSecurity::ServerSecurity(const SecurityOptions& options, const SocketAccess& socket_access,
                               const ListenAddress& address, std::shared_ptr<const AccessList> list,
                               std::unique_ptr<ServerTls> tls)
    : options_(options),
      socket_access_(socket_access),
      role_of_everybody_(RoleOfEverybody(options, address)),
      entries_(list == nullptr ? 0 : list->size()),
      authenticator_(role_of_everybody_ ? Authenticator(LocalPrincipal(*role_of_everybody_))
                                        : Authenticator(std::move(list))),
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
  const absl::Time now = absl::Now();
  if (tls_ == nullptr || (tls_->begins() <= now && now + kExpiryWarning < tls_->expires())) return;
  if (!tls_->IsValidAt(now)) {
    LogError(absl::StrCat("the certificate in --tls-certificate=", options_.tls_certificate,
                          " is valid from ", MinuteText(tls_->begins()), " to ",
                          MinuteText(tls_->expires()), " only, and now it is ", MinuteText(now),
                          ": clients cannot connect while it is not valid. If the clock is right, "
                          "get a new one and send SIGHUP"));
    return;
  }
  Log(Severity::kWarning,
      absl::StrCat("the certificate in --tls-certificate=", options_.tls_certificate,
                   " is valid until ", MinuteText(tls_->expires()),
                   " only: get a new one, and send SIGHUP"));
}

std::string ServerSecurity::Description() const {
  std::vector<std::string> parts;
  if (tls_ != nullptr) {
    parts.push_back(absl::StrCat("TLS, certificate valid until ", DateText(tls_->expires())));
  }
  if (role_of_everybody_) {
    parts.push_back(absl::StrCat("no credentials required, every client has the role ",
                                 RoleName(*role_of_everybody_)));
  }
  if (socket_access_.IsOpenToOthers()) {
    parts.push_back(absl::StrFormat("a Unix socket with mode %04o, the kernel identifies its users",
                                    socket_access_.mode));
  }
  if (!options_.access_file.empty()) {
    parts.push_back(absl::StrCat(entries_, " entries in ", AccessFile(options_).Text()));
  }
  return absl::StrJoin(parts, ", ");
}

}  // namespace ballpiston::server
