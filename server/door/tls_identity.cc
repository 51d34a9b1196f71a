#include "server/door/tls_identity.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <ctime>
#include <memory>
#include <vector>

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

// OpenSSL's last error, which never quotes a file. Empties OpenSSL's error queue.
std::string WhyNot() {
  const char* reason = ERR_reason_error_string(ERR_peek_last_error());
  ERR_clear_error();
  return reason == nullptr ? "no reason given" : reason;
}

Bio Reading(const std::string& pem) {
  return Bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
}

// Prevents OpenSSL from asking at the terminal.
int NoPassphrase(char*, int, int, void*) { return 0; }

std::vector<Certificate> Certificates(const std::string& pem) {
  std::vector<Certificate> all;
  const Bio bio = Reading(pem);
  while (X509* next = PEM_read_bio_X509(bio.get(), nullptr, &NoPassphrase, nullptr)) {
    all.emplace_back(next);
  }
  ERR_clear_error();  // reading always ends with the error "no start line"
  return all;
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
    ERR_clear_error();
    return Unusable(
        files.key, absl::StrCat("is not the key of the certificate in ", files.certificate.Text()));
  }
  return absl::OkStatus();
}

std::string Written(BIO& bio) {
  const char* data = nullptr;
  const long size = BIO_get_mem_data(&bio, &data);
  return std::string(data, static_cast<size_t>(size));
}

// Writes only the certificates, without other contents of the file.
std::string Pem(const std::vector<Certificate>& certificates) {
  const Bio bio(BIO_new(BIO_s_mem()));
  for (const Certificate& one : certificates) PEM_write_bio_X509(bio.get(), one.get());
  return Written(*bio);
}

std::string Pem(EVP_PKEY& key) {
  const Bio bio(BIO_new(BIO_s_secmem()));
  PEM_write_bio_PrivateKey(bio.get(), &key, nullptr, nullptr, 0, nullptr, nullptr);
  return Written(*bio);
}

}  // namespace

absl::StatusOr<TlsIdentity> ReadTlsIdentity(const TlsFiles& files) {
  const absl::StatusOr<std::string> chain = ReadPublicFile(files.certificate);
  if (!chain.ok()) return chain.status();
  const std::vector<Certificate> certificates = Certificates(*chain);
  if (certificates.empty()) {
    return Unusable(files.certificate, "has no certificate in PEM format");
  }
  const absl::StatusOr<std::string> key_text = ReadPrivateFile(files.key);
  if (!key_text.ok()) return key_text.status();
  const Key key(PEM_read_bio_PrivateKey(Reading(*key_text).get(), nullptr, &NoPassphrase, nullptr));
  if (key == nullptr) {
    ERR_clear_error();
    return Unusable(files.key, "has no private key that can be read without a passphrase (PEM)");
  }
  const absl::Status usable = TryOut(files, certificates.front().get(), key.get());
  if (!usable.ok()) return usable;
  const X509* const own = certificates.front().get();
  return TlsIdentity{absl::StrCat(Pem(certificates), Pem(*key)), TimeOf(X509_get0_notBefore(own)),
                     TimeOf(X509_get0_notAfter(own))};
}

}  // namespace ballpiston::server
