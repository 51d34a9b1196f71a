// Limits on the streams and on the other calls of a principal.
#include "server/rpc/quota.h"

#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

TEST(Quota, EachPrincipalHasItsOwnLimit) {
  Quota calls({.what = "calls", .reason = "TOO_MANY_CALLS", .of_one = {2, "most-of-one"}});
  auto first = calls.Take("ann");
  const auto second = calls.Take("ann");
  ASSERT_OK(first);
  ASSERT_OK(second);
  EXPECT_THAT(calls.Take("ann"),
              StatusIs(absl::StatusCode::kResourceExhausted,
                       "ann would have 3 calls; this server permits 2 (--most-of-one)"));
  EXPECT_OK(calls.Take("bob"));
  EXPECT_THAT(calls.ByPrincipal(), ElementsAre(Pair("ann", 2)));
  first->reset();
  EXPECT_OK(calls.Take("ann"));
}

// Each stream has a thread.
TEST(Quota, StreamsAreAlwaysLimited) {
  Quotas quotas({.max_streams = 0, .max_streams_per_principal = 0});
  const auto most = quotas.streams.Take("ann", kMostStreams);
  EXPECT_OK(most);
  EXPECT_EQ(ReasonOf(quotas.streams.Take("bob")), "TOO_MANY_STREAMS");
  EXPECT_EQ(MostStreams({.max_streams = 3}), 3);
  EXPECT_EQ(MostStreams({.max_streams = 10 * kMostStreams}), kMostStreams);
}

TEST(Turns, NoMoreThanTheseComputeAtATime) {
  Turns turns;
  std::atomic<int> computing = 0, most = 0;
  {
    std::vector<std::jthread> threads(8);
    for (std::jthread& thread : threads) {
      thread = std::jthread([&] {
        for (int turn = 0; turn < 100; ++turn) {
          turns.Await(2);
          most = std::max<int>(most, ++computing);
          std::this_thread::yield();
          --computing;
          turns.End();
        }
      });
    }
  }
  EXPECT_LE(most, 2);
}

// ---- unread answers ----

// Each answer has a large job, which the client's gRPC does not take before the client reads it.
TEST(UnreadAnswers, CountAsCallsInProgress) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate)});
  v1::GetEnsembleJobRequest request;
  request.set_name(server.Submit(LargeEquilibrium()));
  const auto evaluate = [&server] { return ReasonOf(server.Call(v1::EvaluatePairsRequest())); };
  const auto channel = OwnChannel(server.address(), nullptr, SmallWindow());
  std::vector<std::unique_ptr<NamedCall>> unread;
  for (int64_t mib = 0; mib < 2 * kMostMibOfCalls; mib += kMibOfCall) {
    unread.push_back(std::make_unique<NamedCall>(channel, kGetJob));
    unread.back()->Send(request.SerializeAsString());
    unread.back()->AwaitAnswer();
  }
  EXPECT_EQ(evaluate(), "TOO_MANY_CALLS");
  unread.clear();
  // Then the server sees the ends of the calls.
  AwaitThat([&] { return evaluate() != "TOO_MANY_CALLS"; });
}

}  // namespace
}  // namespace ballpiston::server
