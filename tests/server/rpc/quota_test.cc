// Limits on the calls of a principal: on their number and their memory (unread answers count), on
// streams, and on calls that compute.
#include "server/rpc/quota.h"

#include <latch>

#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

Quota::Rule Calls(Quota::Limit all, Quota::Limit of_one) {
  return {.what = "calls", .reason = "TOO_MANY_CALLS", .all = all, .of_one = of_one};
}

TEST(Quota, EachPrincipalHasItsOwnLimit) {
  Quota calls(Calls({}, {2, "most-of-one"}));
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

TEST(Quota, AmountsAreLimitedButASingleOneIsPermitted) {
  Quota bytes(Calls({}, {10, "most-bytes"}));
  auto large = bytes.Take("ann", 11);
  ASSERT_OK(large);
  EXPECT_THAT(bytes.Take("ann", 1), StatusIs(absl::StatusCode::kResourceExhausted));
  large->reset();
  const auto half = bytes.Take("ann", 5);
  ASSERT_OK(half);
  EXPECT_OK(bytes.Take("ann", 5));
  const Quota::Part answer = bytes.TakeAnyway("ann", 6);
  EXPECT_THAT(bytes.Take("ann", 5), StatusIs(absl::StatusCode::kResourceExhausted));
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

// A turn that is waited for in a thread of its own.
class WaitedTurn {
 public:
  WaitedTurn(Quota& turns, const std::string& principal)
      : thread_([this, &turns, principal] {
          const Quota::Part turn = turns.Await(principal);
          taken_.count_down();
          end_.wait();
        }) {}
  ~WaitedTurn() {
    end_.count_down();
    thread_.join();
  }
  void AwaitTaken() { taken_.wait(); }
  bool is_taken() const { return taken_.try_wait(); }

 private:
  std::latch taken_{1}, end_{1};
  std::thread thread_;
};

TEST(Quota, OnePrincipalLeavesTurnsToOthers) {
  Quota turns({.all = {2}, .of_one = {1}});
  auto first = std::make_unique<WaitedTurn>(turns, "ann");
  first->AwaitTaken();
  WaitedTurn second(turns, "ann"), other(turns, "bob");
  other.AwaitTaken();
  EXPECT_FALSE(second.is_taken());
  first.reset();
  second.AwaitTaken();
}

// Calls with unread answers, each of which holds a large job.
class UnreadAnswers : public testing::Test {
 protected:
  grpc::Status Evaluate() {
    grpc::ClientContext context;
    v1::EvaluatePairsResponse response;
    return server_->analytic().EvaluatePairs(&context, {}, &response);
  }

  std::unique_ptr<NamedCall> Unread() {
    v1::GetEnsembleJobRequest request;
    request.set_name(name_);
    auto call = std::make_unique<NamedCall>(server_->channel(), kGetJob);
    call->Send(request.SerializeAsString());
    call->AwaitAnswer();
    return call;
  }

  void Start(const Limits& limits) {
    server_.emplace(TestServerOptions{.factory = GatedExperiments(gate_), .limits = limits});
    name_ = server_->Submit(LargeEquilibrium());
  }

  void ExpectRefusedUntilLetGo(const std::string& flag) {
    std::unique_ptr<NamedCall> unread;
    grpc::Status refused;
    AwaitThat([&] {  // the server knows that the answers before it were read
      unread = Unread();
      refused = Evaluate();
      return ReasonOf(refused) == "TOO_MANY_CALLS";
    });
    EXPECT_THAT(refused, StatusIs(grpc::StatusCode::RESOURCE_EXHAUSTED));
    EXPECT_THAT(refused.error_message(), HasSubstr("(--" + flag + ")"));
    unread.reset();
    // Then the server has seen the end.
    AwaitThat([&] { return ReasonOf(Evaluate()) != "TOO_MANY_CALLS"; });
  }

  Gate gate_;
  std::optional<RunningServer> server_;
  std::string name_;
};

TEST_F(UnreadAnswers, CountAsCallsInProgressWithTheirBytes) {
  Start({.max_calls_per_principal = 1});
  ExpectRefusedUntilLetGo("max-calls-per-principal");
  Start({.max_call_bytes_per_principal = 100'000});
  ExpectRefusedUntilLetGo("max-call-bytes-per-principal");
}

}  // namespace
}  // namespace ballpiston::server
