// A server whose store is bounded: the oldest results expire, those of a pinned job stay, and an
// expired question can be asked again.

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
  return run;
}

// 40 points whose results take 800 kB.
ProcessResult RunSweep(const TestServer& server, int seed) {
  return RunWhenThereIsRoom(
      server,
      Joined({Split("--resume first-hit --rho 0.53 --delta 0.1:0.2:40 --epsilon 0.1 --exponent 1"),
              {"--samples", "500", "--seed", absl::StrCat(seed)}}));
}

std::string NameOf(const ProcessResult& run) {
  return At(ParseJson(run.out), "job", "name").string_value();
}

bool HasExpired(const TestServer& server, const std::string& name) {
  const google::protobuf::Struct list = server.Json({"list"});
  for (const auto& job : At(list, "jobs").list_value().values()) {
    if (At(job, "name").string_value() == name) return At(job, "results_expired").bool_value();
  }
  return false;
}

TEST(Expiry, OldResultsExpireUnlessPinnedAndCanBeComputedAgain) {
  const TestServer server({.flags = {"--max-store-bytes=4000000"}});
  const ProcessResult kept = RunSweep(server, 1), old = RunSweep(server, 2);
  ASSERT_THAT(kept, ExitsWith(0));
  ASSERT_THAT(old, ExitsWith(0));
  const std::string pinned = NameOf(kept), expired = NameOf(old);
  EXPECT_THAT(server.Client({"pin", pinned}).out, HasSubstr(pinned + " pinned"));
  int seed = 3;
  AwaitThat([&] {
    if (HasExpired(server, expired)) return true;
    EXPECT_THAT(RunSweep(server, seed++), ExitsWith(0));
    return testing::Test::HasFailure();
  });

  EXPECT_EQ(PointsOf(server.Client({"result", pinned, "--format", "json"}).out),
            PointsOf(kept.out));
  for (const std::string verb : {"result", "pin"}) {
    const ProcessResult refused = server.Client({verb, expired});
    EXPECT_THAT(refused, Not(ExitsWith(0)));
    EXPECT_THAT(refused.err, AllOf(HasSubstr("expired"), HasSubstr("submit --again " + expired)));
  }
  for (const ProcessResult& again :
       {RunWhenThereIsRoom(server, {"--again", expired}), RunSweep(server, 2)}) {
    EXPECT_THAT(again, ExitsWith(0));
    EXPECT_NE(NameOf(again), expired);
    EXPECT_EQ(PointsOf(again.out), PointsOf(old.out));
  }
}

}  // namespace
}  // namespace ballpiston
