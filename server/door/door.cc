#include "server/door/door.h"

#include <utility>
#include <vector>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "server/door/new_token.h"
#include "server/observability/log.h"

namespace ballpiston::server {
namespace {

absl::Status Refused(const std::string& why) { return absl::InvalidArgumentError(why); }

bool HasTls(const DoorOptions& options) { return !options.tls_certificate.empty(); }

// The flags among these that are given.
std::vector<std::string> Given(const DoorOptions& options) {
  std::vector<std::string> given;
  if (!options.access_file.empty()) given.push_back("--access-file");
  if (!options.tls_certificate.empty()) given.push_back("--tls-certificate");
  if (!options.tls_key.empty()) given.push_back("--tls-key");
  return given;
}

NamedFile AccessFile(const DoorOptions& options) { return {"access-file", options.access_file}; }

std::string DateText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d", time, absl::UTCTimeZone());
}

std::string MinuteText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d %H:%M UTC", time, absl::UTCTimeZone());
}

absl::StatusOr<std::unique_ptr<ServerTls>> ReadTls(const DoorOptions& options) {
  if (!HasTls(options)) return nullptr;
  return ServerTls::Create(
      {{"tls-certificate", options.tls_certificate}, {"tls-key", options.tls_key}});
}

// Empty where the server's user needs no token, or cannot have it.
absl::StatusOr<std::string> NewOwnToken(const DoorOptions& options, const ListenAddress& address) {
  if (!address.IsLoopback() || HasTls(options)) return std::string();
  return RandomToken();
}

}  // namespace

absl::Status CheckCombination(const DoorOptions& options, const ListenAddress& address) {
  if (!address.socket_path.empty()) {
    if (Given(options).empty()) return absl::OkStatus();
    return Refused(absl::StrCat("--listen=", address.Text(),
                                ": only this server's user and root can open its Unix socket; it "
                                "cannot be combined with ",
                                absl::StrJoin(Given(options), ", ")));
  }
  if (options.tls_certificate.empty() != options.tls_key.empty()) {
    return Refused("--tls-certificate and --tls-key: give both or neither");
  }
  std::vector<std::string> missing;
  if (!address.IsLoopback() && !HasTls(options)) {
    missing.push_back("--tls-certificate and --tls-key");
  }
  if (options.access_file.empty() && (HasTls(options) || !address.IsLoopback())) {
    missing.push_back("--access-file");
  }
  if (missing.empty()) return absl::OkStatus();
  return Refused(absl::StrCat(
      "--listen=", address.Text(),
      address.IsLoopback() ? ": a server with TLS needs the tokens of its clients; missing: "
                           : ": other machines can reach this address, so it needs TLS and "
                             "tokens; missing: ",
      absl::StrJoin(missing, " and "), " (or listen on a loopback address or a Unix socket)"));
}

absl::StatusOr<std::unique_ptr<Door>> Door::Create(const DoorOptions& options,
                                                   const ListenAddress& address) {
  if (absl::Status status = CheckCombination(options, address); !status.ok()) return status;
  auto tls = ReadTls(options);
  if (!tls.ok()) return tls.status();
  auto own_token = NewOwnToken(options, address);
  if (!own_token.ok()) return own_token.status();
  auto door = absl::WrapUnique(
      new Door(options, address.socket_path.empty(), *std::move(own_token), *std::move(tls)));
  if (absl::Status read = door->ReadAccessFile(); !read.ok()) return read;
  door->WarnOfExpiry();
  return door;
}

Door::Door(const DoorOptions& options, bool needs_tokens, std::string own_token,
           std::unique_ptr<ServerTls> tls)
    : options_(options),
      needs_tokens_(needs_tokens),
      own_token_(std::move(own_token)),
      tls_(std::move(tls)) {}

std::shared_ptr<grpc::ServerCredentials> Door::Credentials() const {
  return tls_ == nullptr ? grpc::InsecureServerCredentials() : tls_->Credentials();
}

void Door::Open(const ListenAddress& address) {
  if (own_token_.empty()) return;
  absl::StatusOr<OwnToken> file = OwnToken::Write(options_.own_tokens, address.Text(), own_token_);
  if (file.ok()) {
    own_file_.emplace(*std::move(file));
    return;
  }
  Log(Severity::kWarning,
      absl::StrCat("this server's user needs a token of --access-file, because the server's own "
                   "token cannot be written: ",
                   file.status().message()));
}

absl::Status Door::ReadAccessFile() {
  if (!needs_tokens_) return absl::OkStatus();
  AccessList list;
  if (!options_.access_file.empty()) {
    absl::StatusOr<AccessList> read = AccessList::Read(AccessFile(options_));
    if (!read.ok()) return read.status();
    list = *std::move(read);
  }
  entries_ = list.size();
  if (!own_token_.empty()) list.Add({HashOf(own_token_), LocalPrincipal()});
  authenticator_.Replace(std::make_shared<const AccessList>(std::move(list)));
  return absl::OkStatus();
}

absl::Status Door::Reload() {
  std::vector<std::string> errors;
  const absl::Status certificate = tls_ == nullptr ? absl::OkStatus() : tls_->Reload();
  for (const absl::Status& status : {ReadAccessFile(), certificate}) {
    if (!status.ok()) errors.emplace_back(status.message());
  }
  WarnOfExpiry();
  return errors.empty() ? absl::OkStatus() : Refused(absl::StrJoin(errors, "; "));
}

std::optional<absl::Time> Door::CertificateExpiry() const {
  if (tls_ == nullptr) return std::nullopt;
  return tls_->expires();
}

void Door::WarnOfExpiry() const {
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

std::string Door::Description() const {
  if (!needs_tokens_) return "a Unix socket for this server's user, without tokens";
  std::vector<std::string> parts;
  if (tls_ != nullptr) {
    parts.push_back(absl::StrCat("TLS, certificate valid until ", DateText(tls_->expires())));
  }
  if (own_file_) parts.push_back("a token for this server's user");
  if (!options_.access_file.empty()) {
    parts.push_back(absl::StrCat(entries_, " tokens in ", AccessFile(options_).Text()));
  }
  return absl::StrJoin(parts, ", ");
}

}  // namespace ballpiston::server
