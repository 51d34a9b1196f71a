// The answer to a repeated question comes from the store, and the client says so. With --fresh the
// answer is computed again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

Words Asking(const std::string& verb, const Words& flags = {}) {
  return Joined({{verb}, kQuickQuestion, flags});
}

int JobsOf(const TestServer& server) { return Length(At(server.Json({"list"}), "jobs")); }

// The question is repeated before and after a restart.
TEST(AnsweredAgain, RunPrintsTheStoredAnswerAndNamesItsJob) {
  TestServer server;
  const ProcessResult first = server.Client(Asking("run", {"--format", "json"}));
  ASSERT_THAT(first, ExitsWith(0));
  EXPECT_EQ(first.err, "");
  const std::string name = At(ParseJson(first.out), "job", "name").string_value();
  EXPECT_FALSE(At(ParseJson(first.out), "job", "answered_from_store").bool_value());
  for (int restarted = 0; restarted < 2; ++restarted) {
    const ProcessResult again = server.Client(Asking("run", {"--format", "json"}));
    EXPECT_THAT(again, ExitsWith(0));
    EXPECT_THAT(again.err,
                MatchesRegex("answered from the store: " + name +
                             ", computed 2[0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9] "
                             "[0-9][0-9]:[0-9][0-9] UTC \\(--fresh computes it again\\)\n"));
    EXPECT_EQ(At(ParseJson(again.out), "job", "name").string_value(), name);
    EXPECT_TRUE(At(ParseJson(again.out), "job", "answered_from_store").bool_value());
    EXPECT_EQ(PointsOf(again.out), PointsOf(first.out));
    EXPECT_EQ(JobsOf(server), 1);
    server.KillHard();
    server.Start();
  }
}

TEST(AnsweredAgain, FreshComputesTheSameBytesAgain) {
  const TestServer server;
  const ProcessResult first = server.Client(Asking("run", {"--format", "json"}));
  const ProcessResult fresh = server.Client(Asking("run", {"--format", "json", "--fresh"}));
  EXPECT_THAT(fresh, ExitsWith(0));
  EXPECT_EQ(fresh.err, "");
  EXPECT_FALSE(At(ParseJson(fresh.out), "job", "answered_from_store").bool_value());
  EXPECT_NE(At(ParseJson(fresh.out), "job", "name").string_value(),
            At(ParseJson(first.out), "job", "name").string_value());
  EXPECT_EQ(PointsOf(fresh.out), PointsOf(first.out));
  EXPECT_EQ(JobsOf(server), 2);
}

TEST(AnsweredAgain, SubmitPrintsTheNameOfTheStoredJob) {
  const TestServer server;
  const std::string name = server.Submit(kQuickQuestion);
  ASSERT_THAT(server.Client({"watch", name}), ExitsWith(0));
  const ProcessResult again = server.Client(Asking("submit"));
  EXPECT_THAT(again, ExitsWith(0));
  EXPECT_EQ(again.out, name + "\n");
  EXPECT_THAT(again.err, HasSubstr("answered from the store: " + name + ", computed 2"));
  EXPECT_NE(server.Client(Asking("submit", {"--fresh"})).out, again.out);
}

TEST(AnsweredAgain, ProgressNonePrintsNoNote) {
  const TestServer server;
  ASSERT_THAT(server.Client(Asking("run")), ExitsWith(0));
  const ProcessResult again = server.Client(Asking("run", {"--progress", "none"}));
  EXPECT_THAT(again, ExitsWith(0));
  EXPECT_EQ(again.err, "");
}

TEST(Priority, IsStoredAndRejectedOutOfRange) {
  const TestServer server;
  const auto made = server.Json(Asking("run", {"--priority", "-100"}));
  EXPECT_EQ(At(made, "job", "priority").number_value(), -100);
  const ProcessResult rejected = server.Client(Asking("submit", {"--priority", "101"}));
  EXPECT_THAT(rejected, ExitsWith(2));
  EXPECT_THAT(rejected.err, HasSubstr("priority: is 101; permitted: -100 to 100"));
}

}  // namespace
}  // namespace ballpiston
