// A server whose store is bounded: the oldest results expire, and can be computed again.
// tests/server/book/stored_limits_test.cc tests which results stay.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

// The server enforces its limits once a second. Until it has made room, it refuses new jobs.
ProcessResult RunWhenThereIsRoom(const TestServer& server, const Words& question) {
  ProcessResult run;
  AwaitThat([&] {
    run = server.Client(Joined({{"run", "--format", "json"}, question}));
    return run.err.find("TOO_MANY_STORED_BYTES") == std::string::npos;
  });
  EXPECT_THAT(run, ExitsWith(0));
  return run;
}

// 40 points whose results take 800 kB.
ProcessResult RunSweep(const TestServer& server, int seed) {
  const std::string sweep =
      "--resume first-hit --rho 0.53 --delta 0.1:0.2:40 --epsilon 0.1 --exponent 1 --samples 500";
  return RunWhenThereIsRoom(server, Split(absl::StrCat(sweep, " --seed ", seed)));
}

TEST(Expiry, OldResultsExpireAndCanBeComputedAgain) {
  const TestServer server({.flags = {"--max-store-bytes=4000000"}});
  const ProcessResult old = RunSweep(server, 0);
  const std::string name = At(ParseJson(old.out), "job", "name").string_value();
  int seed = 1;
  AwaitThat([&] {
    const ProcessResult result = server.Client({"result", name});
    const bool has_expired = result.err.find("expired") != std::string::npos;
    if (!has_expired) RunSweep(server, seed++);
    return has_expired || testing::Test::HasFailure();
  });
  // The same command computes expired results again, as does the question of the job.
  for (const ProcessResult& again :
       {RunWhenThereIsRoom(server, {"--again", name}), RunSweep(server, 0)}) {
    EXPECT_NE(At(ParseJson(again.out), "job", "name").string_value(), name);
    EXPECT_EQ(PointsOf(again.out), PointsOf(old.out));
  }
}

}  // namespace
}  // namespace ballpiston
