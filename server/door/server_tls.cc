#include "server/door/server_tls.h"

#include <fcntl.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
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

struct Identity {
  std::string certificate_and_key;  // PEM, in one file: always of the same pair
  absl::Time expires;               // of the certificate
};

// ---- the operator's files ----

template <auto Free>
struct Freed {
  template <typename T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Context = std::unique_ptr<SSL_CTX, Freed<SSL_CTX_free>>;

// OpenSSL's last error, which never quotes a file.
std::string WhyNot() {
  const char* reason = ERR_reason_error_string(ERR_peek_last_error());
  return reason == nullptr ? "no reason given" : reason;
}

Bio Reading(const std::string& pem) {
  return Bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
}

// Prevents OpenSSL from asking at the terminal.
int NoPassphrase(char*, int, int, void*) { return 0; }

Certificate FirstCertificate(const std::string& pem) {
  return Certificate(PEM_read_bio_X509(Reading(pem).get(), nullptr, &NoPassphrase, nullptr));
}

Key FirstKey(const std::string& pem) {
  return Key(PEM_read_bio_PrivateKey(Reading(pem).get(), nullptr, &NoPassphrase, nullptr));
}

absl::Time TimeOf(const ASN1_TIME* time) {
  std::tm parts{};
  if (ASN1_TIME_to_tm(time, &parts) != 1) return absl::InfinitePast();
  return absl::FromTM(parts, absl::UTCTimeZone());
}

// Tests certificate and key in a TLS context of their own, as TLS would.
absl::Status TryOut(const TlsFiles& files, X509* certificate, EVP_PKEY* key) {
  const Context context(SSL_CTX_new(TLS_server_method()));
  if (SSL_CTX_use_certificate(context.get(), certificate) != 1) {
    return Unusable(files.certificate, absl::StrCat("the certificate is not usable: ", WhyNot()));
  }
  if (SSL_CTX_use_PrivateKey(context.get(), key) != 1 ||
      SSL_CTX_check_private_key(context.get()) != 1) {
    return Unusable(
        files.key, absl::StrCat("is not the key of the certificate in ", files.certificate.Text()));
  }
  return absl::OkStatus();
}

absl::StatusOr<Identity> ReadIdentity(const TlsFiles& files) {
  const absl::StatusOr<std::string> chain = ReadPublicFile(files.certificate);
  if (!chain.ok()) return chain.status();
  const absl::StatusOr<std::string> key_text = ReadPrivateFile(files.key);
  if (!key_text.ok()) return key_text.status();
  const absl::Cleanup no_errors = [] { ERR_clear_error(); };
  const Key key = FirstKey(*key_text);
  if (key == nullptr) {
    return Unusable(files.key, "has no private key that can be read without a passphrase (PEM)");
  }
  if (FirstCertificate(*chain) == nullptr) {
    return Unusable(files.certificate, "has no certificate in PEM format");
  }
  // gRPC takes the first key and the first certificate of this text.
  std::string both = absl::StrCat(*key_text, "\n", *chain);
  const Certificate own = FirstCertificate(both);
  const absl::Status usable = TryOut(files, own.get(), key.get());
  if (!usable.ok()) return usable;
  return Identity{std::move(both), TimeOf(X509_get0_notAfter(own.get()))};
}

// ---- the file in memory ----

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
  const absl::StatusOr<Identity> identity = ReadIdentity(files_);
  if (!identity.ok()) return identity.status();
  const absl::Time now = absl::Now();
  if (identity->expires <= now && now < expires()) {
    return Unusable(files_.certificate, "has expired, but the certificate in use has not");
  }
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
