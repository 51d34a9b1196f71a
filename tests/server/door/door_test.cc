#include "server/door/door.h"

#include "tests/server/preamble.h"
#include "tests/server/secure_server.h"

namespace ballpiston::server {
namespace {

// The given flags are letters: a(ccess file), c(ertificate), k(ey).
std::string Refusal(const std::string& listen, const std::string& flags) {
  const auto path = [&](char letter) { return flags.find(letter) == flags.npos ? "" : "f"; };
  const absl::Status status = CheckCombination(
      {.access_file = path('a'), .tls_certificate = path('c'), .tls_key = path('k')},
      *ParseListenAddress(listen));
  EXPECT_TRUE(status.ok() || absl::IsInvalidArgument(status)) << status;
  return std::string(status.message());
}

TEST(DoorCombination, OnlySafeCombinationsAreAccepted) {
  const std::map<std::string, std::set<std::string>> accepted = {
      {"unix:/tmp/x", {""}},         {"127.0.0.1:1", {"", "a", "cka"}},
      {"[::1]:1", {"", "a", "cka"}}, {"localhost:1", {"", "a", "cka"}},
      {"0.0.0.0:1", {"cka"}},        {"[::]:1", {"cka"}},
      {"192.168.0.7:1", {"cka"}},    {"node.example.org:1", {"cka"}}};
  for (const auto& [listen, safe] : accepted) {
    for (unsigned set = 0; set < 8; ++set) {
      std::string flags;
      for (unsigned i = 0; i < 3; ++i) flags += (set >> i & 1) != 0 ? std::string(1, "cka"[i]) : "";
      EXPECT_EQ(Refusal(listen, flags).empty(), safe.count(flags) == 1) << listen << " " << flags;
    }
  }
}

TEST(DoorCombination, AnErrorNamesTheNeededFlags) {
  const std::string needed = "give --tls-certificate, --tls-key and --access-file";
  for (const char* flags : {"", "ck", "a"}) {
    EXPECT_THAT(Refusal("0.0.0.0:1", flags), HasSubstr(needed)) << flags;
  }
  EXPECT_THAT(Refusal("127.0.0.1:1", "ck"), HasSubstr(needed));
  EXPECT_THAT(Refusal("127.0.0.1:1", "c"), HasSubstr("both or neither"));
  EXPECT_THAT(Refusal("unix:x", "ck"), HasSubstr("cannot be combined with --access-file"));
}

// ---- the loopback without TLS ----

TEST(Loopback, TheOwnTokenIsThatOfTheServersUserAndEndsWithTheServer) {
  const TemporaryFolder data;
  const TestServerOptions options = {.data_dir = data.path(), .listen = "127.0.0.1:0"};
  std::string first;
  {
    RunningServer server(options);
    const std::string folder = data.File("tokens"), file = folder + "/" + server.address();
    EXPECT_EQ(ModeOf(file), 0600u);
    EXPECT_EQ(ModeOf(folder), 0700u);
    first = Contents(file);
    EXPECT_EQ(first.back(), '\n');
    first.pop_back();
    EXPECT_OK(CallByName(server.channel(), kListJobs, "", Bearer(first)));
    EXPECT_EQ(ReasonOf(CallByName(server.channel(), kListJobs)), "CREDENTIALS_MISSING");
  }
  EXPECT_TRUE(std::filesystem::is_empty(data.path() + "/tokens"));
  RunningServer server(options);
  EXPECT_EQ(ReasonOf(CallByName(server.channel(), kListJobs, "", Bearer(first))),
            "CREDENTIALS_INVALID");
}

TEST(Loopback, WithoutAnOwnTokenTheServerWarnsAndServes) {
  const LaboratoryFiles files;
  const ListenAddress address = *ParseListenAddress("127.0.0.1:1");
  ASSERT_OK_AND_ASSIGN(const auto door,
                       Door::Create({.access_file = files.options().access_file,
                                     .own_tokens = files.Write("file", "") + "/tokens"},
                                    address));
  const std::string tokens = "5 tokens in --access-file=" + files.options().access_file;
  EXPECT_EQ(door->Description(), "a token for this server's user, " + tokens);
  ::testing::internal::CaptureStderr();
  door->PublishOwnToken(address);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("this server's user needs a token of --access-file"));
  EXPECT_EQ(door->Description(), tokens);
  EXPECT_OK(door->authenticator().Authenticate({std::string("Bearer ") + kAlice}, absl::Now()));
}

// The other descriptions are tested above and below.
TEST(DoorDescription, NamesAUnixSocket) {
  EXPECT_EQ(Door::Create({}, *ParseListenAddress("unix:/tmp/x")).value()->Description(),
            "a Unix socket for this server's user, without tokens");
}

class SecureServer : public ::testing::Test {
 protected:
  TestClient NewAlice() { return TestClient(server_.NewChannel(files_.Credentials(kAlice))); }
  // Lists the jobs on a new connection.
  grpc::Status List() { return NewAlice().Call(v1::ListEnsembleJobsRequest()); }
  std::string ServedCommonName() const {
    return SilentTlsConnection(server_.address()).served_common_name();
  }
  absl::Status Reload() { return server_.server().Reload(); }

  const LaboratoryFiles files_;
  RunningServer server_{Secure(files_)};
};

// The old pair serves until both files are new. New connections then get the new certificate when
// gRPC has read it; existing ones go on.
TEST_F(SecureServer, AKeyMayBeRenewedBeforeItsCertificate) {
  const TestClient alice = NewAlice();
  alice.List();
  const KeyAndCertificate renewed = files_.authority().Issue("server-2");
  files_.Write("server.key", renewed.key);
  files_.WriteAccessFile("");
  EXPECT_THAT(std::string(Reload().message()),
              AllOf(StartsWith("the access file is reloaded; the certificate is not reloaded, "),
                    HasSubstr("--tls-key=")));
  EXPECT_EQ(ReasonOf(List()), "CREDENTIALS_INVALID");  // revoked at once
  files_.WriteAccessFile(LaboratoryTokens());
  EXPECT_FALSE(Reload().ok());
  EXPECT_OK(List());
  EXPECT_EQ(ServedCommonName(), "server-1");
  files_.Write("server.pem", renewed.certificate);
  files_.WriteAccessFile("nonsense\n");
  EXPECT_FALSE(Reload().ok());  // the access file is wrong; the certificate is used
  AwaitThat([this] { return ServedCommonName() == "server-2"; });
  EXPECT_OK(List());
  EXPECT_EQ(alice.channel()->GetState(false), GRPC_CHANNEL_READY);
  alice.List();
}

// For example because the clock is not set yet after a boot.
TEST(Start, WithAnExpiredCertificateTheServerStartsAndLogs) {
  using std::chrono::hours;
  const LaboratoryFiles files;
  files.WriteCertificate(files.authority().Issue("expired", {hours(-2), hours(-1)}));
  ::testing::internal::CaptureStderr();
  RunningServer server(Secure(files));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr(" has expired, so clients cannot connect: "));
  const auto check = [&] {
    return CallByName(server.NewChannel(files.Credentials()), kCheckHealth);
  };
  EXPECT_THAT(check(), StatusIs(grpc::StatusCode::UNAVAILABLE));
  files.WriteCertificate(files.authority().Issue("good"));
  EXPECT_OK(server.server().Reload());
  AwaitThat([&] { return check().ok(); });
}

TEST_F(SecureServer, AnExpiredCertificateDoesNotReplaceAValidOne) {
  using std::chrono::hours;
  files_.WriteCertificate(files_.authority().Issue("expired", {hours(-2), hours(-1)}));
  EXPECT_THAT(Reload(), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("has expired")));
  EXPECT_OK(List());
}

// The certificates here are valid for 24 hours by default.
TEST_F(SecureServer, ACertificateThatEndsSoonIsLogged) {
  EXPECT_THAT(server_.server().door().Description(),
              testing::MatchesRegex("TLS, certificate valid until [-0-9]+ [0-9]+:[0-9]+ UTC, "
                                    "5 tokens in --access-file=.*"));
  for (const auto& [hours, is_soon] : {std::pair(24, true), {365 * 24, false}}) {
    files_.WriteCertificate(
        files_.authority().Issue("server-2", {.until = std::chrono::hours(hours)}));
    ::testing::internal::CaptureStderr();
    EXPECT_OK(Reload());
    const std::string log = ::testing::internal::GetCapturedStderr();
    EXPECT_EQ(absl::StrContains(log, "warning: the certificate in "), is_soon) << log;
    const absl::Duration rest = *server_.server().door().CertificateExpiry() - absl::Now();
    EXPECT_NEAR(absl::ToDoubleHours(rest), hours, 0.2);
  }
}

}  // namespace
}  // namespace ballpiston::server
