// The programs with TLS and tokens, as an operator and a user use them.
#include "tests/credentials/test_authority.h"
#include "tests/end_to_end/programs.h"
#include "tests/server/http_get.h"

namespace ballpiston {
namespace {

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

  // A new token of this principal and role, which is also in the file `token_NAME`.
  std::string NewToken(const std::string& name, const std::string& role) {
    const ProcessResult made = RunProgram(ClientCommand(
        home_, {"server", "token", name + ":" + role, "--access-file", home_.File("access")}));
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

  ProcessResult Client(const Words& words) {
    ProcessResult result = server_->Client(words);
    client_output_ += result.out + result.err;
    return result;
  }
  Words Known(const std::string& name) const {
    return {"--ca", home_.File("ca.pem"), "--token-file", home_.File("token_" + name)};
  }
  ProcessResult List(const Words& flags) { return Client(Joined({{"list"}, flags})); }

  const TemporaryFolder home_;
  const TestAuthority authority_{"authority"};
  std::optional<TestServer> server_;
  std::string client_output_;  // the output of all clients
};

TEST_F(Security, ErrorsSayWhatToTry) {
  NewToken("alice", "read");
  Start(TlsFlags());
  const TestAuthority other("other");
  Write("other.pem", other.Pem());
  Write("token_wrong", "no-such-token");
  const auto expect = [&](const Words& flags, int code, const std::string& text) {
    const ProcessResult result = List(flags);
    EXPECT_THAT(result, ExitsWith(code));
    EXPECT_THAT(result.err, HasSubstr(text));
  };
  EXPECT_THAT(List(Known("alice")), ExitsWith(0));
  expect({}, 3, "if the server uses TLS: --ca FILE");
  expect({"--ca", home_.File("other.pem")}, 3, "name the right authority with --ca FILE");
  expect({"--tls"}, 3, "that this system knows");
  expect({"--ca", home_.File("ca.pem")}, 6, "CREDENTIALS_MISSING");
  expect(Known("wrong"), 6, "CREDENTIALS_INVALID");
  WriteCertificate(authority_.IssueForHost("elsewhere.example.org"));
  Start(TlsFlags());
  expect({"--ca", home_.File("ca.pem")}, 3, "is for another host");
  Start({"--access-file", home_.File("access")});  // without TLS
  expect({"--ca", home_.File("ca.pem")}, 3, "does not use TLS");
  EXPECT_THAT(List({}), ExitsWith(0));  // the server's own user
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
  NewToken("alice", "read");
  Start(TlsFlags(), {"sh", "-c", "ulimit -S -n 256 && exec \"$@\"", "sh"});
  EXPECT_THAT(List(Known("alice")), ExitsWith(0));
  const double before = server_->ResidentMiB();
  const auto silent = HalfOpen(server_->address(), 500, "");
  const auto begun = HalfOpen(server_->address(), 500, "\x16\x03\x01");
  EXPECT_THAT(List(Known("alice")), ExitsWith(0));
  EXPECT_LT(server_->ResidentMiB() - before, kMiB);
}

// Then the service manager, or the next client, starts it again.
TEST_F(Security, WithoutDescriptorsTheServerEnds) {
  Start({}, {"sh", "-c", "ulimit -n 64 && exec \"$@\"", "sh"});
  const auto connections = HalfOpen(server_->address(), 100, "");
  EXPECT_EQ(server_->AwaitEnd(), 1);
  EXPECT_THAT(server_->log(), HasSubstr("the server can accept no more connections and ends"));
}

// The server reads the access file again at SIGHUP.
TEST_F(Security, NoTokenIsInTheLogTheStoreOrTheOutputOfAClient) {
  const std::string tokens[] = {NewToken("alice", "submit"), NewToken("gone", "submit"),
                                NewToken("reader", "read")};
  Start(TlsFlags());
  EXPECT_THAT(Client(Joined({{"run"}, kQuickQuestion, Known("alice")})), ExitsWith(0));
  EXPECT_THAT(Client(Joined({{"submit"}, kQuickQuestion, Known("reader")})), ExitsWith(6));
  // First the access file lacks the token; then the file is malformed and holds the token itself.
  const std::string access = Contents(home_.File("access"));
  Write("access", access.substr(0, access.find('\n') + 1));
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->AwaitLog("reloaded: "));
  EXPECT_THAT(List(Known("gone")), ExitsWith(6));
  Write("access", "token " + tokens[1] + " gone submit\n");
  server_->Signal(SIGHUP);
  ASSERT_TRUE(
      server_->AwaitLog("the access file is not reloaded, its previous content stays in use"));
  EXPECT_THAT(List(Known("alice")), ExitsWith(0));
  EXPECT_THAT(List({"--token-file", home_.File("token_gone")}), ExitsWith(3));  // without TLS
  EXPECT_EQ(server_->Stop(), 0);
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
