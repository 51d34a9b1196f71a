// The files of the server's certificate and key are checked.
#include "server/door/server_tls.h"

#include "tests/server/secure_server.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

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

TEST_F(ServerTlsTest, PairsOfKeyAndCertificateAreAccepted) {
  using std::chrono::hours;
  EXPECT_EQ(Error(), "");
  // The clock may be set only later.
  for (const Validity validity : {Validity{hours(-2), hours(-1)}, Validity{hours(1), hours(2)}}) {
    files_.WriteCertificate(files_.authority().Issue("x", validity));
    EXPECT_EQ(Error(), "");
  }
  // Some authorities deliver the key and the certificate in one file.
  const KeyAndCertificate made = files_.authority().Issue("x");
  const std::string both = made.certificate + made.key;
  files_.WriteCertificate({both, both});
  EXPECT_EQ(Error(), "");
}

TEST_F(ServerTlsTest, OtherFilesAreRefused) {
  const KeyAndCertificate made = files_.authority().Issue("x"), other = other_.Issue("y");
  const struct {
    KeyAndCertificate files;
    const char* error;
  } rows[] = {
      {{made.certificate, other.key}, "--tls-key="},
      {{made.certificate, other.key}, "is not the key of the certificate in --tls-certificate="},
      // gRPC would take the certificate beside the key.
      {{made.certificate, made.key + other.certificate}, "is not the key of the certificate"},
      {{made.certificate, "nonsense"}, "has no private key"},
      {{"", made.key}, "--tls-certificate"},
      {{"nonsense", made.key}, "--tls-certificate"},
      {{"-----BEGIN CERTIFICATE-----\nAAAA\n", made.key}, "--tls-certificate"}};
  for (const auto& [files, error] : rows) {
    files_.WriteCertificate(files);
    EXPECT_THAT(Error(), HasSubstr(error));
  }
  files_.WriteCertificate(made);
  chmod(files_.options().tls_key.c_str(), 0644);
  EXPECT_THAT(Error(), HasSubstr("open to other users (mode 0644)"));
  unlink(files_.options().tls_key.c_str());
  EXPECT_THAT(Error(), AllOf(HasSubstr("--tls-key="), HasSubstr("No such file")));
}

}  // namespace
}  // namespace ballpiston::server
