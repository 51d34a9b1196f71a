#include "server/door/door.h"

#include <utility>
#include <vector>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "server/sha256.h"
#include "server/status/log.h"

namespace ballpiston::server {
namespace {

absl::Status Refused(const std::string& why) { return absl::InvalidArgumentError(why); }

bool HasTls(const DoorOptions& options) { return !options.tls_certificate.empty(); }

NamedFile AccessFile(const DoorOptions& options) { return {"access-file", options.access_file}; }

std::string MinuteText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d %H:%M UTC", time, absl::UTCTimeZone());
}

std::string Outcome(const char* part, const absl::Status& reloaded) {
  if (reloaded.ok()) return absl::StrCat(part, " is reloaded");
  return absl::StrCat(part,
                      " is not reloaded, its previous content stays in use: ", reloaded.message());
}

absl::StatusOr<std::unique_ptr<ServerTls>> ReadTls(const DoorOptions& options) {
  if (!HasTls(options)) return nullptr;
  return ServerTls::Create(
      {{"tls-certificate", options.tls_certificate}, {"tls-key", options.tls_key}});
}

}  // namespace

absl::Status CheckCombination(const DoorOptions& options, const ListenAddress& address) {
  const bool has_access_file = !options.access_file.empty();
  const std::string listen = absl::StrCat("--listen=", address.Text(), ": ");
  if (!address.socket_path.empty()) {
    if (!has_access_file && !HasTls(options) && options.tls_key.empty()) return absl::OkStatus();
    return Refused(listen +
                   "only this server's user and root can open its Unix socket; it cannot be "
                   "combined with --access-file, --tls-certificate or --tls-key");
  }
  if (HasTls(options) == options.tls_key.empty()) {
    return Refused("--tls-certificate and --tls-key: give both or neither");
  }
  if (HasTls(options) ? has_access_file : address.IsLoopback()) return absl::OkStatus();
  return Refused(listen +
                 "an address that other machines can reach needs TLS, and TLS needs an access "
                 "file: give --tls-certificate, --tls-key and --access-file (or listen without "
                 "TLS on 127.0.0.1, [::1] or localhost, or on a Unix socket)");
}

absl::StatusOr<std::unique_ptr<Door>> Door::Create(const DoorOptions& options,
                                                   const ListenAddress& address) {
  if (absl::Status status = CheckCombination(options, address); !status.ok()) return status;
  auto tls = ReadTls(options);
  if (!tls.ok()) return tls.status();
  auto door = absl::WrapUnique(new Door(options, address.socket_path.empty()));
  door->tls_ = *std::move(tls);
  if (absl::Status read = door->ReadAccessFile(); !read.ok()) return read;
  if (address.IsLoopback() && door->tls_ == nullptr) door->own_token_.emplace();
  door->AcceptTokens();
  door->WarnOfExpiry();
  return door;
}

std::shared_ptr<grpc::ServerCredentials> Door::Credentials() const {
  return tls_ == nullptr ? grpc::InsecureServerCredentials() : tls_->Credentials();
}

void Door::PublishOwnToken(const ListenAddress& address) {
  if (!own_token_) return;
  const absl::Status published = own_token_->Publish(options_.own_tokens, address.Text());
  if (published.ok()) return;
  own_token_.reset();
  Log(Severity::kWarning,
      absl::StrCat("this server's user needs a token of --access-file, because the server's own "
                   "token cannot be written: ",
                   published.message()));
}

absl::Status Door::ReadAccessFile() {
  if (options_.access_file.empty()) return absl::OkStatus();
  absl::StatusOr<AccessList> read = AccessList::Read(AccessFile(options_));
  if (read.ok()) access_ = *std::move(read);
  return read.status();
}

void Door::AcceptTokens() {
  AccessList list = access_;
  if (own_token_) list.Add({Sha256(own_token_->token()), LocalPrincipal()});
  authenticator_.Accept(std::move(list));
}

absl::Status Door::Reload() {
  const absl::Status access = ReadAccessFile();
  const absl::Status certificate = tls_ == nullptr ? absl::OkStatus() : tls_->Reload();
  AcceptTokens();
  WarnOfExpiry();
  if (access.ok() && certificate.ok()) return absl::OkStatus();
  std::string outcome = Outcome("the access file", access);
  if (tls_ != nullptr) absl::StrAppend(&outcome, "; ", Outcome("the certificate", certificate));
  return Refused(outcome);
}

std::optional<absl::Time> Door::CertificateExpiry() const {
  if (tls_ == nullptr) return std::nullopt;
  return tls_->expires();
}

void Door::WarnOfExpiry() const {
  if (tls_ == nullptr || absl::Now() + kExpiryWarning < tls_->expires()) return;
  const bool is_valid = absl::Now() < tls_->expires();
  Log(is_valid ? Severity::kWarning : Severity::kError,
      absl::StrCat("the certificate in --tls-certificate=", options_.tls_certificate,
                   is_valid ? " is valid until " : " has expired, so clients cannot connect: ",
                   MinuteText(tls_->expires()), "; get a new one, and send SIGHUP"));
}

std::string Door::Description() const {
  if (!needs_tokens_) return "a Unix socket for this server's user, without tokens";
  std::vector<std::string> parts;
  if (tls_ != nullptr) {
    parts.push_back(absl::StrCat("TLS, certificate valid until ", MinuteText(tls_->expires())));
  }
  if (own_token_) parts.push_back("a token for this server's user");
  if (!options_.access_file.empty()) {
    parts.push_back(absl::StrCat(access_.size(), " tokens in ", AccessFile(options_).Text()));
  }
  return absl::StrJoin(parts, ", ");
}

}  // namespace ballpiston::server
