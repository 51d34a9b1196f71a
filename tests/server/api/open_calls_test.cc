// The calls of a principal and their memory, also of unread answers; and the turns of calls that
// compute.
#include "server/api/open_calls.h"

#include <latch>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/api/turns.h"
#include "tests/server/call_by_name.h"
#include "tests/server/error_details.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/server/unread_call.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

constexpr Limits kTwoCallsOfTenBytes = {.max_calls_per_principal = 2,
                                        .max_call_bytes_per_principal = 10};

TEST(OpenCalls, EachPrincipalHasItsOwnCalls) {
  OpenCalls calls(kTwoCallsOfTenBytes);
  auto first = calls.Begin("ann", 1);
  const auto second = calls.Begin("ann", 1);
  ASSERT_OK(first);
  ASSERT_OK(second);
  const auto third = calls.Begin("ann", 1);
  EXPECT_THAT(third, StatusIs(absl::StatusCode::kResourceExhausted,
                              HasSubstr("permits 2 (--max-calls-per-principal)")));
  EXPECT_OK(calls.Begin("bob", 1));
  first->reset();
  EXPECT_OK(calls.Begin("ann", 1));
}

TEST(OpenCalls, BytesAreLimitedButASingleCallIsPermitted) {
  OpenCalls calls(kTwoCallsOfTenBytes);
  auto large = calls.Begin("ann", 11);
  ASSERT_OK(large);
  EXPECT_THAT(calls.Begin("ann", 1), StatusIs(absl::StatusCode::kResourceExhausted,
                                              HasSubstr("10 (--max-call-bytes-per-principal)")));
  large->reset();
  const auto half = calls.Begin("ann", 5);
  ASSERT_OK(half);
  EXPECT_OK(calls.Begin("ann", 5));
  (*half)->AddBytes(1);  // an answer
  EXPECT_THAT(calls.Begin("ann", 5), StatusIs(absl::StatusCode::kResourceExhausted));
}

TEST(OpenCalls, ZeroMeansUnlimited) {
  const Limits none = {.max_calls_per_principal = 0, .max_call_bytes_per_principal = 0};
  OpenCalls calls(none);
  std::vector<std::shared_ptr<OpenCalls::Call>> open;
  for (int i = 0; i < 2000; ++i) {
    auto call = calls.Begin("ann", 1 << 30);
    ASSERT_OK(call);
    open.push_back(*std::move(call));
  }
}

// A turn that is waited for in a thread of its own.
class WaitedTurn {
 public:
  WaitedTurn(Turns& turns, const std::string& principal)
      : thread_([this, &turns, principal] {
          const Turns::Turn turn(turns, principal);
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

TEST(Turns, OnePrincipalLeavesTurnsToOthers) {
  Turns turns(2, 1);
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

  std::unique_ptr<UnreadCall> Unread() {
    v1::GetEnsembleJobRequest request;
    request.set_name(name_);
    auto call = std::make_unique<UnreadCall>(server_->channel(), kGetJob);
    call->Send(request.SerializeAsString());
    call->AwaitAnswer();
    return call;
  }

  void Start(const Limits& limits) {
    server_.emplace(TestServerOptions{.factory = GatedExperiments(gate_), .limits = limits});
    name_ = server_->Submit(LargeEquilibrium());
  }

  void ExpectRefusedUntilLetGo(const std::string& flag) {
    std::unique_ptr<UnreadCall> unread;
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

TEST_F(UnreadAnswers, CountAsCallsInProgress) {
  Start({.max_calls_per_principal = 1});
  ExpectRefusedUntilLetGo("max-calls-per-principal");
}

TEST_F(UnreadAnswers, CountWithTheirBytes) {
  Start({.max_call_bytes_per_principal = 100'000});
  ExpectRefusedUntilLetGo("max-call-bytes-per-principal");
}

}  // namespace
}  // namespace ballpiston::server
