// The programs with TLS and tokens, as an operator and a user use them.
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/credentials/test_authority.h"
#include "tests/end_to_end/programs.h"
#include "tests/server/http_get.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

class Security : public ::testing::Test {
 protected:
  Security() {
    WriteCertificate(authority_.Issue("server"));
    Write("ca.pem", authority_.Pem());
  }

  std::string Write(const std::string& name, const std::string& text) {
    WriteFile(home_.File(name), text);
    chmod(home_.File(name).c_str(), 0600);
    return home_.File(name);
  }
  void WriteCertificate(const KeyAndCertificate& made) {
    Write("server.pem", made.certificate);
    Write("server.key", made.key);
  }

  // A new token, which is also in the file `token_NAME`.
  std::string NewToken(const std::string& name, const std::string& request) {
    const ProcessResult made =
        RunServer(home_, {"--access-file", home_.File("access"), "--new-token", request});
    EXPECT_THAT(made, ExitsWith(0));
    EXPECT_EQ(made.err, "");
    Write("token_" + name, made.out);
    return made.out.substr(0, made.out.find('\n'));
  }

  Words TlsFlags() const {
    return {"--tls-certificate",      home_.File("server.pem"), "--tls-key",
            home_.File("server.key"), "--access-file",          home_.File("access")};
  }

  void Start(const Words& flags, const Words& launcher = {}) {
    server_.emplace(ServerSetUp{.flags = flags, .listen = "127.0.0.1:0", .launcher = launcher});
  }

  ProcessResult Client(const Words& words,
                       const std::map<std::string, std::string>& environment = {}) {
    ProcessOptions options = server_->Command(words);
    for (const auto& [name, value] : environment) options.environment[name] = value;
    ProcessResult result = RunProgram(options);
    client_output_ += result.out + result.err;
    return result;
  }
  Words Known(const std::string& name) const {
    return {"--ca", home_.File("ca.pem"), "--token-file", home_.File("token_" + name)};
  }
  ProcessResult List(const Words& flags,
                     const std::map<std::string, std::string>& environment = {}) {
    return Client(Joined({{"list"}, flags}), environment);
  }

  const TemporaryFolder home_;
  const TestAuthority authority_{"authority"};
  std::optional<TestServer> server_;
  std::string client_output_;  // the output of all clients
};

TEST_F(Security, AJobIsHiddenFromOtherTokens) {
  NewToken("alice", "alice:submit");
  NewToken("bob", "bob:submit:7");
  NewToken("reader", "alice:read");
  Start(TlsFlags());
  const ProcessResult submitted = Client(Joined({{"submit"}, kQuickQuestion, Known("alice")}));
  ASSERT_THAT(submitted, ExitsWith(0));
  const std::string job = submitted.out.substr(0, submitted.out.find('\n'));
  const auto exit_code_of = [&](const std::string& verb, const std::string& name) {
    return Client(Joined({{verb, job}, Known(name)})).exit_code;
  };
  EXPECT_EQ(exit_code_of("watch", "alice"), 0);
  EXPECT_EQ(exit_code_of("result", "reader"), 0);
  EXPECT_EQ(exit_code_of("delete", "reader"), 6);
  EXPECT_EQ(exit_code_of("result", "bob"), 5);
  EXPECT_EQ(exit_code_of("watch", "bob"), 5);
  EXPECT_EQ(exit_code_of("delete", "bob"), 5);
  EXPECT_EQ(exit_code_of("delete", "alice"), 0);
}

TEST_F(Security, TheEnvironmentReplacesFlags) {
  const std::string token = NewToken("alice", "alice:read");
  Start(TlsFlags());
  const std::string ca = home_.File("ca.pem");
  EXPECT_THAT(
      List({}, {{"BALLPISTON_CA", ca}, {"BALLPISTON_TOKEN_FILE", home_.File("token_alice")}}),
      ExitsWith(0));
  EXPECT_THAT(List({}, {{"BALLPISTON_CA", ca}, {"BALLPISTON_TOKEN", token}}), ExitsWith(0));
  // A flag takes precedence over its variable, and the token file over the token.
  EXPECT_THAT(List(Known("alice"), {{"BALLPISTON_CA", "/none"}, {"BALLPISTON_TOKEN", "wrong"}}),
              ExitsWith(0));
  EXPECT_THAT(List({}, {{"BALLPISTON_CA", ca}}), ExitsWith(6));
}

TEST_F(Security, ErrorsSayWhatToTry) {
  NewToken("alice", "alice:read");
  Start(TlsFlags());
  const TestAuthority other("other");
  Write("other.pem", other.Pem());
  Write("token_wrong", "no-such-token");
  const auto expect = [&](const Words& flags, int code, const std::string& text) {
    const ProcessResult result = List(flags);
    EXPECT_THAT(result, ExitsWith(code));
    EXPECT_THAT(result.err, HasSubstr(text));
  };
  expect({}, 3, "if the server uses TLS: --ca FILE");
  expect({"--ca", home_.File("other.pem")}, 3, "name the right authority with --ca FILE");
  expect({"--tls"}, 3, "that this system knows");
  expect({"--ca", home_.File("ca.pem")}, 6, "CREDENTIALS_MISSING");
  expect(Known("wrong"), 6, "CREDENTIALS_INVALID");
  chmod(home_.File("token_alice").c_str(), 0644);
  expect(Known("alice"), 6, "chmod 600");
  WriteCertificate(authority_.IssueForHost("elsewhere.example.org"));
  Start(TlsFlags());
  expect({"--ca", home_.File("ca.pem")}, 3, "is for another host");
}

TEST_F(Security, ErrorOfTlsToAPlainServerSaysSo) {
  Start({});
  const ProcessResult result = List({"--ca", home_.File("ca.pem")});
  EXPECT_THAT(result, ExitsWith(3));
  EXPECT_THAT(result.err, HasSubstr("does not use TLS"));
  EXPECT_THAT(List({}), ExitsWith(0));
}

TEST(UnixSocket, OnlyItsUserCanOpenIt) {
  const TestServer server;
  EXPECT_EQ(ModeOf(server.folder().File("socket")) & 077u, 0u);
}

TEST_F(Security, OnTheLoopbackOtherUsersNeedAToken) {
  NewToken("alice", "alice:read");
  Start({"--access-file", home_.File("access")});
  EXPECT_THAT(List({}), ExitsWith(0));
  const std::map<std::string, std::string> other_user = {{"HOME", home_.path()}};
  const ProcessResult refused = List({}, other_user);
  EXPECT_THAT(refused, ExitsWith(6));
  EXPECT_THAT(refused.err, HasSubstr("CREDENTIALS_MISSING"));
  EXPECT_THAT(List({"--token-file", home_.File("token_alice")}, other_user), ExitsWith(0));
}

// Connections that send `begin` and nothing else.
std::vector<std::unique_ptr<server::Connection>> HalfOpen(const std::string& address, int count,
                                                          const std::string& begin) {
  rlimit descriptors{};
  getrlimit(RLIMIT_NOFILE, &descriptors);
  descriptors.rlim_cur = descriptors.rlim_max;
  setrlimit(RLIMIT_NOFILE, &descriptors);
  std::vector<std::unique_ptr<server::Connection>> connections;
  for (int i = 0; i < count; ++i) {
    connections.push_back(std::make_unique<server::Connection>(address));
    connections.back()->Send(begin);
  }
  return connections;
}

// With a login's default limit of descriptors the server could not accept so many connections.
TEST_F(Security, AThousandHalfOpenConnectionsLeaveTheServerToOthers) {
  constexpr double kMiB = 64;
  NewToken("alice", "alice:read");
  Start(TlsFlags(), {"sh", "-c", "ulimit -S -n 256 && exec \"$@\"", "sh"});
  EXPECT_THAT(List(Known("alice")), ExitsWith(0));
  const double before = server_->ResidentMiB();
  const auto silent = HalfOpen(server_->address(), 500, "");
  const auto begun = HalfOpen(server_->address(), 500, "\x16\x03\x01");
  EXPECT_THAT(List(Known("alice")), ExitsWith(0));
  EXPECT_LT(server_->ResidentMiB() - before, kMiB);
}

TEST_F(Security, WithoutDescriptorsTheLogSaysThatNobodyCanConnect) {
  Start({}, {"sh", "-c", "ulimit -n 64 && exec \"$@\"", "sh"});
  const auto connections = HalfOpen(server_->address(), 100, "");
  EXPECT_TRUE(server_->AwaitLog("the server accepts no more connections; raise its limit"));
}

TEST_F(Security, SighupReadsTheFilesAgainAndIgnoresInvalidOnes) {
  NewToken("alice", "alice:read");
  Start(TlsFlags());
  NewToken("bob", "bob:read");
  EXPECT_THAT(List(Known("bob")), ExitsWith(6));
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->AwaitLog("reloaded: "));
  EXPECT_THAT(List(Known("bob")), ExitsWith(0));
  Write("access", "nonsense\n");
  server_->Signal(SIGHUP);
  ASSERT_TRUE(
      server_->AwaitLog("the access file is not reloaded, its previous content stays in use"));
  EXPECT_THAT(List(Known("bob")), ExitsWith(0));
  EXPECT_EQ(server_->Stop(), 0);
}

TEST_F(Security, UnsafeFlagsExitWithTwoAndOneLine) {
  NewToken("alice", "alice:read");
  const auto expect = [&](const Words& flags, const std::string& text) {
    const ProcessResult result =
        RunServer(home_, Joined({flags, {"--data_dir", home_.File("data")}}));
    EXPECT_THAT(result, ExitsWith(2));
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  expect({"--listen", "0.0.0.0:0"}, "give --tls-certificate, --tls-key and --access-file");
  expect(Joined({TlsFlags(), {"--listen", "unix:" + home_.File("s")}}),
         "can open its Unix socket; it cannot be combined with --access-file");
  expect({"--new-token", "alice:read"}, "--new-token requires --access-file");
  chmod(home_.File("server.key").c_str(), 0644);
  expect(Joined({TlsFlags(), {"--listen", "127.0.0.1:0"}}), "is open to other users");
}

TEST_F(Security, NoTokenIsInTheLogTheStoreOrTheOutputOfAClient) {
  const std::string tokens[] = {NewToken("alice", "alice:submit"), NewToken("gone", "bob:submit"),
                                NewToken("reader", "carol:read")};
  Start(TlsFlags());
  EXPECT_THAT(Client(Joined({{"run"}, kQuickQuestion, Known("alice")})), ExitsWith(0));
  EXPECT_THAT(Client(Joined({{"submit"}, kQuickQuestion, Known("reader")})), ExitsWith(6));
  // First the access file lacks the token; then the file is malformed and holds the token itself.
  const std::string access = Contents(home_.File("access"));
  Write("access", access.substr(0, access.find('\n') + 1));
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->AwaitLog("reloaded: "));
  EXPECT_THAT(List(Known("gone")), ExitsWith(6));
  Write("access", "token " + tokens[1] + " bob submit\n");
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->AwaitLog("not reloaded"));
  EXPECT_THAT(List({"--token-file", home_.File("token_gone")}), ExitsWith(3));  // without TLS
  server_->Stop();
  std::string all = client_output_ + server_->log() + access;
  for (const auto& entry : std::filesystem::directory_iterator(server_->data_dir())) {
    if (entry.is_regular_file()) all += Contents(entry.path());
  }
  EXPECT_GT(all.size(), 1000u);
  for (const std::string& token : tokens) {
    EXPECT_EQ(token.size(), 46u);
    EXPECT_EQ(all.find(token.substr(3)), std::string::npos);
  }
  EXPECT_EQ(all.find("PRIVATE KEY"), std::string::npos);
}

}  // namespace
}  // namespace ballpiston
