#include "tests/credentials/test_authority.h"

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <atomic>
#include <stdexcept>

namespace ballpiston {
namespace {

using Key = std::shared_ptr<EVP_PKEY>;
using Certificate = std::shared_ptr<X509>;

void Must(bool done) {
  if (!done) throw std::runtime_error("OpenSSL made no certificate");
}

Key NewKey() {
  const Key key(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  Must(key != nullptr);
  return key;
}

Certificate Unsigned(const std::string& common_name, EVP_PKEY& key, Validity validity) {
  const Certificate certificate(X509_new(), &X509_free);
  Must(X509_set_version(certificate.get(), X509_VERSION_3) == 1);
  static std::atomic<int64_t> serial_number = 0;
  Must(ASN1_INTEGER_set_int64(X509_get_serialNumber(certificate.get()), ++serial_number) == 1);
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), validity.from.count());
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), validity.until.count());
  Must(X509_set_pubkey(certificate.get(), &key) == 1);
  const auto* text = reinterpret_cast<const unsigned char*>(common_name.c_str());
  Must(X509_NAME_add_entry_by_txt(X509_get_subject_name(certificate.get()), "CN", MBSTRING_UTF8,
                                  text, -1, -1, 0) == 1);
  return certificate;
}

void Extend(X509& certificate, int extension, const std::string& value) {
  X509_EXTENSION* made = X509V3_EXT_conf_nid(nullptr, nullptr, extension, value.c_str());
  Must(made != nullptr && X509_add_ext(&certificate, made, -1) == 1);
  X509_EXTENSION_free(made);
}

void Sign(X509& certificate, X509& issuer, EVP_PKEY& key) {
  Must(X509_set_issuer_name(&certificate, X509_get_subject_name(&issuer)) == 1);
  Must(X509_sign(&certificate, &key, EVP_sha256()) > 0);
}

template <typename Write>
std::string Pem(Write write) {
  const std::shared_ptr<BIO> bio(BIO_new(BIO_s_mem()), &BIO_free);
  Must(write(bio.get()) == 1);
  const char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return std::string(data, static_cast<size_t>(size));
}

std::string PemOf(X509& certificate) {
  return Pem([&](BIO* bio) { return PEM_write_bio_X509(bio, &certificate); });
}

std::string PemOf(EVP_PKEY& key) {
  return Pem([&](BIO* bio) {
    return PEM_write_bio_PrivateKey(bio, &key, nullptr, nullptr, 0, nullptr, nullptr);
  });
}

}  // namespace

TestAuthority::TestAuthority(const std::string& name) : key_(NewKey()) {
  certificate_ = Unsigned(name, *key_, Validity());
  Extend(*certificate_, NID_basic_constraints, "critical,CA:TRUE");
  Extend(*certificate_, NID_key_usage, "critical,keyCertSign,cRLSign");
  Sign(*certificate_, *certificate_, *key_);
}

std::string TestAuthority::Pem() const { return PemOf(*certificate_); }

KeyAndCertificate TestAuthority::Issue(const std::string& common_name, Validity validity,
                                       const std::string& hosts) const {
  const Key key = NewKey();
  const Certificate certificate = Unsigned(common_name, *key, validity);
  Extend(*certificate, NID_subject_alt_name, hosts);
  Sign(*certificate, *certificate_, *key_);
  return {PemOf(*certificate), PemOf(*key)};
}

}  // namespace ballpiston
