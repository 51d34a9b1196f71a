#include "client/library/channel_security.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <map>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/library/local_server.h"
#include "client/library/server_address.h"

namespace ballpiston::client {
namespace {

constexpr size_t kMaxFileBytes = size_t{1} << 20;
constexpr size_t kLongestToken = 256;

absl::Status CannotUse(const std::string& what, const std::string& path, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("the ", what, " ", path, " ", why));
}

absl::Status CheckOwnersOnly(const std::string& what, const std::string& path, int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return CannotUse(what, path, std::strerror(errno));
  constexpr mode_t kForOthers = S_IRWXG | S_IRWXO;
  if ((status.st_mode & kForOthers) == 0) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrFormat(
      "the %s %s is open to other users (mode %04o): run chmod 600 on it; if others "
      "may have read it, request a new one",
      what, path, status.st_mode & 07777));
}

// Reads a regular file or a pipe to its end. `what` names the file in messages. Only its owner may
// be able to read a secret file.
absl::StatusOr<std::string> ReadFile(const std::string& what, const std::string& path,
                                     bool is_secret) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return CannotUse(what, path, absl::StrCat("cannot be opened: ", std::strerror(errno)));
  }
  const absl::Cleanup closed = [descriptor] { close(descriptor); };
  const absl::Status own = is_secret ? CheckOwnersOnly(what, path, descriptor) : absl::OkStatus();
  if (!own.ok()) return own;
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

bool IsToken(absl::string_view text) {
  return !text.empty() && text.size() <= kLongestToken &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return absl::ascii_isgraph(c); });
}

// Empty if there is none.
absl::StatusOr<std::string> Token(const ChannelSecurity& security) {
  std::string token = security.token;
  if (!security.token_file.empty()) {
    absl::StatusOr<std::string> text =
        ReadFile("token file", security.token_file, /*is_secret=*/true);
    if (!text.ok()) return text.status();
    token = std::string(absl::StripAsciiWhitespace(*text));
  }
  if (IsToken(token) || !security.HasToken()) return token;
  return absl::InvalidArgumentError(absl::StrCat(
      security.token_file.empty() ? "the token" : "the token file " + security.token_file,
      " must be one word of 1 to ", kLongestToken, " printable characters"));
}

// Adds the token to calls to a loopback address, without encryption. If the user gives no token,
// the own server's token is read for each call, because the server makes another at each start.
class LoopbackToken : public grpc::MetadataCredentialsPlugin {
 public:
  LoopbackToken(std::string address, std::string token)
      : address_(std::move(address)), token_(std::move(token)) {}

  bool IsBlocking() const override { return false; }
  grpc::Status GetMetadata(grpc::string_ref, grpc::string_ref, const grpc::AuthContext&,
                           std::multimap<grpc::string, grpc::string>* metadata) override {
    const std::string token = token_.empty() ? OwnToken(address_) : token_;
    if (!token.empty()) metadata->emplace("authorization", absl::StrCat("Bearer ", token));
    return grpc::Status::OK;
  }

 private:
  const std::string address_, token_;
};

// The connection is refused if the address turns out to be of another machine.
std::shared_ptr<grpc::ChannelCredentials> LoopbackCredentials(const std::string& address,
                                                              const std::string& token) {
  return grpc::CompositeChannelCredentials(
      grpc::experimental::LocalCredentials(LOCAL_TCP),
      grpc::experimental::MetadataCredentialsFromPlugin(
          std::make_unique<LoopbackToken>(address, token), GRPC_SECURITY_NONE));
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> TlsCredentials(const std::string& ca) {
  constexpr char kWhat[] = "authority file", kBegin[] = "-----BEGIN CERTIFICATE-----";
  grpc::SslCredentialsOptions options;
  if (ca.empty()) return grpc::SslCredentials(options);  // trusts the system's authorities
  absl::StatusOr<std::string> text = ReadFile(kWhat, ca, /*is_secret=*/false);
  if (!text.ok()) return text.status();
  if (!absl::StrContains(*text, kBegin)) {  // gRPC would only report that the connection failed
    return CannotUse(kWhat, ca, absl::StrCat("holds no \"", kBegin, "\" (a PEM file is needed)"));
  }
  options.pem_root_certs = *std::move(text);
  return grpc::SslCredentials(options);
}

}  // namespace

std::string OwnToken(const std::string& address) {
  char machine[HOST_NAME_MAX + 1] = {};
  gethostname(machine, HOST_NAME_MAX);
  std::string token;
  std::ifstream(StateFolder() + "/tokens/" + machine + "/" + address) >> token;
  return token;
}

absl::Status CheckSecurity(const ChannelSecurity& security, absl::string_view address) {
  if (absl::StartsWith(address, "unix:") && (security.HasTls() || security.HasToken())) {
    return absl::InvalidArgumentError(
        "a Unix socket uses neither TLS nor a token: only the server's own user can open it");
  }
  if (security.HasToken() && !security.HasTls() && !IsLoopback(address)) {
    return absl::InvalidArgumentError(
        "a token is not sent to another machine without encryption: use TLS (with the file of the "
        "authority, or with the authorities of this system)");
  }
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> CredentialsOf(
    const ChannelSecurity& security, const std::string& address) {
  const absl::StatusOr<std::string> token = Token(security);
  if (!token.ok()) return token.status();
  if (!security.HasTls()) {
    return IsLoopback(address) ? LoopbackCredentials(address, *token)
                               : grpc::InsecureChannelCredentials();
  }
  auto channel = TlsCredentials(security.ca);
  if (!channel.ok() || token->empty()) return channel;
  return grpc::CompositeChannelCredentials(*channel, grpc::AccessTokenCredentials(*token));
}

}  // namespace ballpiston::client
