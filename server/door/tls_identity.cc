#include "server/door/tls_identity.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <ctime>
#include <memory>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"

namespace ballpiston::server {
namespace {

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

}  // namespace

absl::StatusOr<TlsIdentity> ReadTlsIdentity(const TlsFiles& files) {
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
  return TlsIdentity{std::move(both), TimeOf(X509_get0_notAfter(own.get()))};
}

}  // namespace ballpiston::server
