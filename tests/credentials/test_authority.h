// An authority of a test's own that signs certificates.
#pragma once

#include <chrono>
#include <memory>
#include <string>

typedef struct evp_pkey_st EVP_PKEY;
typedef struct x509_st X509;

namespace ballpiston {

// When a certificate is valid, counted from now.
struct Validity {
  std::chrono::seconds from = std::chrono::hours(-1);
  std::chrono::seconds until = std::chrono::hours(24);
};

struct KeyAndCertificate {
  std::string certificate;  // PEM
  std::string key;          // PEM
};

class TestAuthority {
 public:
  explicit TestAuthority(const std::string& name);

  std::string Pem() const;

  // For localhost, 127.0.0.1 and ::1, as a server or as a client.
  KeyAndCertificate Issue(const std::string& common_name, Validity validity = {},
                          const std::string& hosts = "DNS:localhost,IP:127.0.0.1,IP:::1") const;
  // For another host, as a server.
  KeyAndCertificate IssueForHost(const std::string& host) const {
    return Issue(host, {}, "DNS:" + host);
  }

 private:
  std::shared_ptr<EVP_PKEY> key_;
  std::shared_ptr<X509> certificate_;
};

}  // namespace ballpiston
