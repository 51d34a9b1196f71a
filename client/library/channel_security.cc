#include "client/library/channel_security.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston::client {
namespace {

constexpr size_t kMaxFileBytes = size_t{1} << 20;
constexpr size_t kLongestToken = 256;

enum class Secret { kNo, kYes };

absl::Status CannotUse(const std::string& what, const std::string& path, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("the ", what, " ", path, " ", why));
}

absl::Status CheckOwnersOnly(const std::string& what, const std::string& path, int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return CannotUse(what, path, std::strerror(errno));
  constexpr mode_t kForOthers = S_IRWXG | S_IRWXO;
  if ((status.st_mode & kForOthers) == 0) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrFormat(
      "the %s %s is open to other users (mode %04o): chmod 600 it; if another user may "
      "have read it, ask for a new one",
      what, path, status.st_mode & 07777));
}

// Reads a regular file or a pipe to its end. `what` names the file in messages.
absl::StatusOr<std::string> ReadFile(const std::string& what, const std::string& path,
                                     Secret secret) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return CannotUse(what, path, absl::StrCat("cannot be opened: ", std::strerror(errno)));
  }
  const absl::Cleanup closed = [descriptor] { close(descriptor); };
  if (secret == Secret::kYes) {
    const absl::Status own = CheckOwnersOnly(what, path, descriptor);
    if (!own.ok()) return own;
  }
  std::string text;
  char buffer[1 << 14];
  while (text.size() <= kMaxFileBytes) {
    const ssize_t size = read(descriptor, buffer, sizeof(buffer));
    if (size == 0) return text;
    if (size < 0) {
      return CannotUse(what, path, absl::StrCat("cannot be read: ", std::strerror(errno)));
    }
    text.append(buffer, static_cast<size_t>(size));
  }
  return CannotUse(what, path, absl::StrCat("is longer than ", kMaxFileBytes, " bytes"));
}

// Checks that the file looks like PEM. Without this check gRPC would only report that the
// connection failed.
absl::StatusOr<std::string> ReadPem(const std::string& what, const std::string& path,
                                    absl::string_view kind, Secret secret) {
  if (path.empty()) return std::string();
  absl::StatusOr<std::string> text = ReadFile(what, path, secret);
  if (!text.ok() || absl::StrContains(*text, kind)) return text;
  return CannotUse(what, path, absl::StrCat("holds no \"", kind, "\" (a PEM file is needed)"));
}

bool IsToken(absl::string_view text) {
  return !text.empty() && text.size() <= kLongestToken &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return absl::ascii_isgraph(c); });
}

absl::StatusOr<std::string> Token(const ChannelSecurity& security) {
  std::string token = security.token;
  if (!security.token_file.empty()) {
    absl::StatusOr<std::string> text = ReadFile("token file", security.token_file, Secret::kYes);
    if (!text.ok()) return text.status();
    token = std::string(absl::StripAsciiWhitespace(*text));
  }
  if (IsToken(token)) return token;
  return absl::InvalidArgumentError(absl::StrCat(
      security.token_file.empty() ? "the token" : "the token file " + security.token_file,
      " must be one word of 1 to ", kLongestToken, " printable characters"));
}

absl::StatusOr<grpc::SslCredentialsOptions> ReadTlsFiles(const ChannelSecurity& security) {
  constexpr char kCertificate[] = "-----BEGIN CERTIFICATE-----";
  constexpr char kKey[] = "PRIVATE KEY-----";
  auto ca = ReadPem("authority file", security.ca, kCertificate, Secret::kNo);
  auto chain = ReadPem("certificate file", security.certificate, kCertificate, Secret::kNo);
  auto key = ReadPem("key file", security.key, kKey, Secret::kYes);
  for (const absl::Status& status : {ca.status(), chain.status(), key.status()}) {
    if (!status.ok()) return status;
  }
  grpc::SslCredentialsOptions options;
  options.pem_root_certs = *std::move(ca);
  options.pem_cert_chain = *std::move(chain);
  options.pem_private_key = *std::move(key);
  return options;
}

}  // namespace

absl::Status CheckSecurity(const ChannelSecurity& security, absl::string_view address) {
  const bool is_socket = absl::StartsWith(address, "unix:");
  if (is_socket && (security.HasTls() || security.HasToken())) {
    return absl::InvalidArgumentError(
        "a Unix socket uses neither TLS nor a token: the system tells the server who you are");
  }
  if (security.certificate.empty() != security.key.empty()) {
    return absl::InvalidArgumentError("a certificate and its key are needed together");
  }
  if (security.HasToken() && !security.HasTls()) {
    return absl::InvalidArgumentError(
        "a token is not sent over an unencrypted connection: use TLS (with the file of the "
        "authority, or with the authorities of this system)");
  }
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> CredentialsOf(
    const ChannelSecurity& security) {
  if (!security.HasTls()) return grpc::InsecureChannelCredentials();
  const auto files = ReadTlsFiles(security);
  if (!files.ok()) return files.status();
  auto channel = grpc::SslCredentials(*files);
  if (!security.HasToken()) return channel;
  const absl::StatusOr<std::string> token = Token(security);
  if (!token.ok()) return token.status();
  return grpc::CompositeChannelCredentials(channel, grpc::AccessTokenCredentials(*token));
}

}  // namespace ballpiston::client
