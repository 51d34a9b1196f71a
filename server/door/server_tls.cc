#include "server/door/server_tls.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "absl/cleanup/cleanup.h"
#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "grpcpp/security/tls_certificate_provider.h"
#include "grpcpp/security/tls_credentials_options.h"

namespace ballpiston::server {
namespace {

constexpr unsigned kLookSeconds = 1;

bool Fill(int descriptor, const std::string& content, time_t changed) {
  const timespec times[2] = {{changed, 0}, {changed, 0}};
  return write(descriptor, content.data(), content.size()) ==
             static_cast<ssize_t>(content.size()) &&
         fchmod(descriptor, 0600) == 0 && futimens(descriptor, times) == 0;
}

}  // namespace

absl::StatusOr<std::unique_ptr<ServerTls>> ServerTls::Create(TlsFiles files) {
  auto tls = absl::WrapUnique(new ServerTls(std::move(files)));
  const absl::Status loaded = tls->Reload();
  if (!loaded.ok()) return loaded;
  return tls;
}

ServerTls::~ServerTls() {
  if (descriptor_ >= 0) close(descriptor_);
}

absl::Status ServerTls::Reload() {
  const absl::StatusOr<TlsIdentity> identity = ReadTlsIdentity(files_);
  if (!identity.ok()) return identity.status();
  const absl::Status exchanged = Exchange(identity->certificate_and_key);
  if (exchanged.ok()) expires_ = absl::ToUnixSeconds(identity->expires);
  return exchanged;
}

// The file as a whole: a reader sees the old content or the new one. The time of change is at least
// a second later than the previous one, because gRPC compares times to notice an exchange between
// its two reads of one pair.
absl::Status ServerTls::Exchange(const std::string& content) {
  changed_ = std::max(std::time(nullptr), changed_ + 1);
  int next = memfd_create("ballpiston", MFD_CLOEXEC);
  const absl::Cleanup closed = [&next] { close(next); };
  if (next < 0 || !Fill(next, content, changed_)) {
    return absl::InternalError(
        absl::StrCat("no memory for the certificates in use: ", std::strerror(errno)));
  }
  if (descriptor_ < 0) {
    descriptor_ = std::exchange(next, -1);
    return absl::OkStatus();
  }
  // With two open descriptors it fails only with EINTR or, during an open(2) of the same number,
  // with EBUSY; both are temporary.
  while (dup3(next, descriptor_, O_CLOEXEC) < 0 && (errno == EINTR || errno == EBUSY)) {
  }
  return absl::OkStatus();
}

// Valid only in this process, and as long as this object lives.
std::string ServerTls::PathInMemory() const { return absl::StrCat("/proc/self/fd/", descriptor_); }

std::shared_ptr<grpc::ServerCredentials> ServerTls::Credentials() const {
  const std::string path = PathInMemory();
  grpc::experimental::TlsServerCredentialsOptions options(
      std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(path, path,
                                                                           kLookSeconds));
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace ballpiston::server
