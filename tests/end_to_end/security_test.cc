// The programs with TLS and tokens, as an operator and a user see them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/credentials/test_authority.h"
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

using Words = std::vector<std::string>;

void Append(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

class Security : public ::testing::Test {
 protected:
  Security() {
    WriteCertificate(authority_.Issue("server"));
    Write("ca.pem", authority_.Pem());
  }

  std::string Write(const std::string& name, const std::string& text) {
    std::ofstream(home_.Path(name)) << text;
    chmod(home_.Path(name).c_str(), 0600);
    return home_.Path(name);
  }
  void WriteCertificate(const KeyAndCertificate& made) {
    Write("server.pem", made.certificate);
    Write("server.key", made.key);
  }
  std::string Read(const std::string& name) const {
    std::ifstream in(home_.Path(name));
    return {std::istreambuf_iterator<char>(in), {}};
  }

  ProcessResult Server(const Words& flags) { return RunProgram(ServerCommand(home_, flags)); }

  // A new token, which is also in the file `token_NAME`.
  std::string NewToken(const std::string& name, const std::string& request) {
    const ProcessResult made =
        Server({"--access-file", home_.Path("access"), "--new-token", request});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_EQ(made.err, "");
    Write("token_" + name, made.out);
    return made.out.substr(0, made.out.find('\n'));
  }

  Words TlsFlags() const {
    return {"--tls-certificate",      home_.Path("server.pem"), "--tls-key",
            home_.Path("server.key"), "--access-file",          home_.Path("access")};
  }

  void Start(const Words& more) {
    Words flags = {"--listen", "127.0.0.1:0", "--data-dir", home_.Path("data")};
    Append(flags, more);
    server_ = std::make_unique<Process>(ServerCommand(home_, flags));
    const std::string line = server_->WaitForErrLine(
        [](const std::string& text) { return text.find("listening on") != std::string::npos; });
    ASSERT_NE(line, "") << server_->Wait().err;
    address_ = line.substr(line.rfind(' ') + 1);
  }

  ProcessResult Client(const Words& words, std::map<std::string, std::string> environment = {}) {
    ProcessOptions options{
        .command = {BALLPISTON_CLIENT_BINARY}, .environment = CleanEnvironment(home_), .input = ""};
    for (const auto& [name, value] : environment) options.environment[name] = value;
    Append(options.command, words);
    Append(options.command, {"--server", address_});
    ProcessResult result = RunProgram(options);
    said_ += result.out + result.err;
    return result;
  }
  Words Known(const std::string& name) const {
    return {"--ca", home_.Path("ca.pem"), "--token-file", home_.Path("token_" + name)};
  }
  ProcessResult List(const Words& flags, std::map<std::string, std::string> environment = {}) {
    Words words = {"list"};
    Append(words, flags);
    return Client(words, std::move(environment));
  }

  const TemporaryFolder home_;
  const TestAuthority authority_{"authority"};
  std::unique_ptr<Process> server_;
  std::string address_;
  std::string said_;  // by every client
};

const Words kJob = {"first-hit", "--rho",      "0.53", "--delta",   "0.3", "--epsilon",
                    "0.1",       "--exponent", "1",    "--samples", "4096"};

TEST_F(Security, ATokenRunsAJobThatAnotherTokenDoesNotFind) {
  NewToken("alice", "alice:submit");
  NewToken("bob", "bob:submit:7");
  NewToken("reader", "alice:read");
  Start(TlsFlags());
  Words submit = {"submit"};
  Append(submit, kJob);
  Append(submit, Known("alice"));
  const ProcessResult submitted = Client(submit);
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  const std::string job = submitted.out.substr(0, submitted.out.find('\n'));
  const auto exit_code_of = [&](const std::string& verb, const std::string& name) {
    Words words = {verb, job};
    Append(words, Known(name));
    return Client(words).exit_code;
  };
  EXPECT_EQ(exit_code_of("watch", "alice"), 0);
  EXPECT_EQ(exit_code_of("result", "reader"), 0);
  EXPECT_EQ(exit_code_of("delete", "reader"), 6);
  EXPECT_EQ(exit_code_of("result", "bob"), 5);
  EXPECT_EQ(exit_code_of("watch", "bob"), 5);
  EXPECT_EQ(exit_code_of("delete", "bob"), 5);
  EXPECT_EQ(exit_code_of("delete", "alice"), 0);
}

TEST_F(Security, TheEnvironmentServesAsWellAsFlags) {
  const std::string token = NewToken("alice", "alice:read");
  Start(TlsFlags());
  const std::string ca = home_.Path("ca.pem");
  EXPECT_EQ(List({}, {{"BALLPISTON_CA", ca}, {"BALLPISTON_TOKEN_FILE", home_.Path("token_alice")}})
                .exit_code,
            0);
  EXPECT_EQ(List({}, {{"BALLPISTON_CA", ca}, {"BALLPISTON_TOKEN", token}}).exit_code, 0);
  // A flag wins over its variable, and the file over the token itself.
  EXPECT_EQ(
      List(Known("alice"), {{"BALLPISTON_CA", "/none"}, {"BALLPISTON_TOKEN", "wrong"}}).exit_code,
      0);
  EXPECT_EQ(List({}, {{"BALLPISTON_CA", ca}}).exit_code, 6);
}

TEST_F(Security, WhatFailsSaysWhatToTry) {
  NewToken("alice", "alice:read");
  Start(TlsFlags());
  const TestAuthority other("other");
  Write("other.pem", other.Pem());
  Write("token_wrong", "no-such-token");
  const auto expect = [&](const Words& flags, int code, const std::string& text) {
    const ProcessResult result = List(flags);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
  };
  expect({}, 3, "if that server wants TLS: --ca FILE");
  expect({"--ca", home_.Path("other.pem")}, 3, "name the right one with --ca FILE");
  expect({"--tls"}, 3, "that this system knows");
  expect({"--ca", home_.Path("ca.pem")}, 6, "CREDENTIALS_MISSING");
  expect(Known("wrong"), 6, "CREDENTIALS_INVALID");
  expect({"--token-file", home_.Path("token_alice")}, 2, "others can read");
  expect({"--cert", home_.Path("server.pem")}, 2, "together");
  chmod(home_.Path("token_alice").c_str(), 0644);
  expect(Known("alice"), 6, "chmod 600");
  WriteCertificate(authority_.IssueForHost("elsewhere.example.org"));
  server_.reset();
  Start(TlsFlags());
  expect({"--ca", home_.Path("ca.pem")}, 3, "is for another host");
}

TEST_F(Security, TlsToAServerWithoutItSaysSo) {
  Start({});
  const ProcessResult result = List({"--ca", home_.Path("ca.pem")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("does not speak TLS"));
  EXPECT_EQ(List({}).exit_code, 0);
}

TEST_F(Security, AClientsCertificateIsAskedForAndTaken) {
  Write("access", "certificate Ada alice read\n");
  const KeyAndCertificate own = authority_.Issue("Ada");
  Words flags = TlsFlags();
  Append(flags, {"--tls-client-ca", home_.Path("ca.pem")});
  Start(flags);
  const Words ca = {"--ca", home_.Path("ca.pem")};
  Words known = ca;
  Append(known, {"--cert", Write("ada.pem", own.certificate), "--key", Write("ada.key", own.key)});
  const ProcessResult listed = List(known);
  EXPECT_EQ(listed.exit_code, 0) << listed.err;
  const ProcessResult without = List(ca);
  EXPECT_EQ(without.exit_code, 3);
  EXPECT_THAT(without.err, HasSubstr("--cert FILE --key FILE"));
}

TEST_F(Security, HangupReadsTheFilesAgainAndKeepsTheOldOnesIfTheyAreWrong) {
  NewToken("alice", "alice:read");
  Start(TlsFlags());
  NewToken("bob", "bob:read");
  EXPECT_EQ(List(Known("bob")).exit_code, 6);
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->WaitForErr("read again: "));
  EXPECT_EQ(List(Known("bob")).exit_code, 0);
  Write("access", "nonsense\n");
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->WaitForErr("not read again, the old stays: --access-file="));
  EXPECT_EQ(List(Known("bob")).exit_code, 0);
  server_->Signal(SIGTERM);
  EXPECT_EQ(server_->Wait().exit_code, 0);
}

TEST_F(Security, UnsafeCombinationsEndWithTwoAndOneLine) {
  NewToken("alice", "alice:read");
  const Words data = {"--data-dir", home_.Path("data")};
  const auto expect = [&](Words flags, const std::string& text) {
    Append(flags, data);
    const ProcessResult result = Server(flags);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  expect({"--listen", "0.0.0.0:0"}, "missing: --tls-certificate and --tls-key and --access-file");
  expect({"--listen", "127.0.0.1:0", "--access-file", home_.Path("access")},
         "others could read the tokens");
  Words over_socket = TlsFlags();
  Append(over_socket, {"--listen", "unix:" + home_.Path("s")});
  expect(over_socket, "over a Unix socket");
  expect({"--new-token", "alice:read"}, "--access-file is missing");
  chmod(home_.Path("server.key").c_str(), 0644);
  Words open_key = TlsFlags();
  Append(open_key, {"--listen", "127.0.0.1:0"});
  expect(open_key, "is open to others");
}

TEST_F(Security, NoTokenIsInTheLogTheStoreOrWhatAClientSays) {
  const std::string tokens[] = {NewToken("alice", "alice:submit"), NewToken("gone", "bob:submit"),
                                NewToken("reader", "carol:read")};
  Start(TlsFlags());
  Words run = {"run"};
  Append(run, kJob);
  Append(run, Known("alice"));
  EXPECT_EQ(Client(run).exit_code, 0);
  Words refused = {"submit"};
  Append(refused, kJob);
  Append(refused, Known("reader"));
  EXPECT_EQ(Client(refused).exit_code, 6);
  // One that the server no longer knows, and one in a file that it cannot read.
  std::string access = Read("access");
  Write("access", access.substr(0, access.find('\n') + 1));
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->WaitForErr("read again: "));
  EXPECT_EQ(List(Known("gone")).exit_code, 6);
  Write("access", "token " + tokens[1] + " bob submit\n");
  server_->Signal(SIGHUP);
  ASSERT_TRUE(server_->WaitForErr("not read again"));
  EXPECT_EQ(List({"--token-file", home_.Path("token_gone")}).exit_code, 2);
  server_->Signal(SIGTERM);
  const ProcessResult ended = server_->Wait();
  std::string all = said_ + ended.out + ended.err + access;
  for (const auto& entry : std::filesystem::directory_iterator(home_.Path("data"))) {
    if (entry.is_regular_file()) all += Read("data/" + entry.path().filename().string());
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
