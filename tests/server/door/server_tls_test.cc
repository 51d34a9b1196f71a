// The files of the server's certificate and key are checked.
#include "server/door/server_tls.h"

#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/secure_server.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ServerTlsTest : public ::testing::Test {
 protected:
  std::string Error() const {
    const absl::Status status =
        ServerTls::Create({{"tls-certificate", files_.options().tls_certificate},
                           {"tls-key", files_.options().tls_key}})
            .status();
    if (status.ok()) return "";
    EXPECT_THAT(status, StatusIs(absl::StatusCode::kInvalidArgument, Not(HasSubstr("BEGIN"))));
    return std::string(status.message());
  }

  const LaboratoryFiles files_;
  const TestAuthority other_{"another authority"};
};

TEST_F(ServerTlsTest, AKeyOfAnotherCertificateIsRefused) {
  files_.Write("server.key", other_.Issue("x").key);
  EXPECT_THAT(Error(), HasSubstr("--tls-key="));
  EXPECT_THAT(Error(), HasSubstr("is not the key of the certificate in --tls-certificate="));
}

// The clock may be set only later.
TEST_F(ServerTlsTest, AnExpiredOrFutureCertificateIsRead) {
  using std::chrono::hours;
  for (const Validity validity : {Validity{hours(-2), hours(-1)}, Validity{hours(1), hours(2)}}) {
    files_.WriteCertificate(files_.authority().Issue("x", validity));
    EXPECT_EQ(Error(), "");
  }
}

TEST_F(ServerTlsTest, AKeyThatOthersMayReadIsRefused) {
  chmod(files_.options().tls_key.c_str(), 0644);
  EXPECT_THAT(Error(), HasSubstr("open to other users (mode 0644)"));
}

TEST_F(ServerTlsTest, AFileThatIsNotPemIsRefused) {
  for (const char* text : {"", "nonsense", "-----BEGIN CERTIFICATE-----\nAAAA\n"}) {
    files_.Write("server.pem", text);
    EXPECT_THAT(Error(), HasSubstr("--tls-certificate")) << text;
  }
  files_.WriteCertificate({files_.authority().Issue("good").certificate, "nonsense"});
  EXPECT_THAT(Error(), HasSubstr("has no private key"));
}

TEST_F(ServerTlsTest, AMissingFileIsNamed) {
  unlink(files_.options().tls_key.c_str());
  EXPECT_THAT(Error(), HasSubstr("--tls-key="));
  EXPECT_THAT(Error(), HasSubstr("No such file"));
}

// Some authorities deliver the key and the certificate in one file.
TEST_F(ServerTlsTest, KeyAndCertificateMayBeInOneFile) {
  const KeyAndCertificate made = files_.authority().Issue("x");
  const std::string both = made.certificate + made.key;
  files_.WriteCertificate({both, both});
  EXPECT_EQ(Error(), "");
}

// gRPC would take that certificate.
TEST_F(ServerTlsTest, AnotherCertificateBesideTheKeyIsRefused) {
  const KeyAndCertificate made = files_.authority().Issue("x");
  files_.WriteCertificate({made.certificate, made.key + other_.Issue("y").certificate});
  EXPECT_THAT(Error(), HasSubstr("is not the key of the certificate"));
}

}  // namespace
}  // namespace ballpiston::server
