// The same question again: answered at once from the store, and said so; with --fresh computed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

using Words = std::vector<std::string>;

// What the billiard answers: its bytes would differ if they were not those of the first time.
const Words kQuestion = {"first-hit", "--rho",  "0.53",       "--delta", "0.2,0.1",
                         "--epsilon", "0.1",    "--exponent", "1",       "--samples",
                         "2000",      "--seed", "7"};

Words Asking(const std::string& verb, const Words& flags = {}) {
  Words words = {verb};
  words.insert(words.end(), kQuestion.begin(), kQuestion.end());
  words.insert(words.end(), flags.begin(), flags.end());
  return words;
}

int JobsOf(const TestServer& server) {
  const ProcessResult list = server.Client({"list", "--format", "json"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  return At(ParseJson(list.out), "jobs").list_value().values_size();
}

// The server is asked again after a restart, too: what it answers with is in the store.
TEST(AnsweredAgain, RunAnswersFromTheStoreAndSaysSo) {
  TestServer server;
  const ProcessResult first = server.Client(Asking("run", {"--format", "json"}));
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.err, "");
  const std::string name = At(ParseJson(first.out), "job", "name").string_value();
  EXPECT_FALSE(At(ParseJson(first.out), "job", "answered_from_store").bool_value());
  for (int restarted = 0; restarted < 2; ++restarted) {
    const ProcessResult again = server.Client(Asking("run", {"--format", "json"}));
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.err, MatchesRegex("answered from the store: " + name +
                                        ", computed 2[0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9] "
                                        "[0-9][0-9]:[0-9][0-9] UTC \\(--fresh computes anew\\)\n"));
    EXPECT_EQ(At(ParseJson(again.out), "job", "name").string_value(), name);
    EXPECT_TRUE(At(ParseJson(again.out), "job", "answered_from_store").bool_value());
    EXPECT_EQ(PointsOf(again.out), PointsOf(first.out));
    EXPECT_EQ(JobsOf(server), 1);
    server.KillHard();
    server.Start();
  }
}

TEST(AnsweredAgain, FreshComputesAnewToTheSameBytes) {
  const TestServer server;
  const ProcessResult first = server.Client(Asking("run", {"--format", "json"}));
  const ProcessResult fresh = server.Client(Asking("run", {"--format", "json", "--fresh"}));
  EXPECT_EQ(fresh.exit_code, 0) << fresh.err;
  EXPECT_EQ(fresh.err, "");
  EXPECT_FALSE(At(ParseJson(fresh.out), "job", "answered_from_store").bool_value());
  EXPECT_NE(At(ParseJson(fresh.out), "job", "name").string_value(),
            At(ParseJson(first.out), "job", "name").string_value());
  EXPECT_EQ(PointsOf(fresh.out), PointsOf(first.out));
  EXPECT_EQ(JobsOf(server), 2);
}

TEST(AnsweredAgain, SubmitPrintsTheNameAloneAndSaysSoBeside) {
  const TestServer server;
  const std::string name = server.Submit(kQuestion);
  ASSERT_EQ(server.Client({"watch", name}).exit_code, 0);
  const ProcessResult again = server.Client(Asking("submit"));
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.out, name + "\n");
  EXPECT_THAT(again.err, HasSubstr("answered from the store: " + name + ", computed 2"));
  EXPECT_NE(server.Client(Asking("submit", {"--fresh"})).out, again.out);
}

TEST(AnsweredAgain, ProgressNoneSaysNothing) {
  const TestServer server;
  ASSERT_EQ(server.Client(Asking("run")).exit_code, 0);
  const ProcessResult again = server.Client(Asking("run", {"--progress", "none"}));
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.err, "");
}

TEST(Priority, IsKeptAndOutOfRangeRefused) {
  const TestServer server;
  const ProcessResult made =
      server.Client(Asking("run", {"--format", "json", "--priority", "-100"}));
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(At(ParseJson(made.out), "job", "priority").number_value(), -100);
  const ProcessResult refused = server.Client(Asking("submit", {"--priority", "101"}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("priority: is 101; permitted: -100 to 100"));
}

}  // namespace
}  // namespace ballpiston
