// The memory that calls with unread answers hold: the class HeldCalls, and through the API.
#include "server/api/held_calls.h"

#include <memory>
#include <optional>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
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

TEST(HeldCalls, EachPrincipalHasItsOwnCalls) {
  HeldCalls calls;
  EXPECT_OK(calls.Begin("ann", 1, kTwoCallsOfTenBytes));
  EXPECT_OK(calls.Begin("ann", 1, kTwoCallsOfTenBytes));
  const absl::Status third = calls.Begin("ann", 1, kTwoCallsOfTenBytes);
  EXPECT_THAT(third, StatusIs(absl::StatusCode::kResourceExhausted));
  EXPECT_THAT(std::string(third.message()), HasSubstr("permits 2 (--max-calls-per-principal)"));
  EXPECT_OK(calls.Begin("bob", 1, kTwoCallsOfTenBytes));
  calls.End("ann", 1);
  EXPECT_OK(calls.Begin("ann", 1, kTwoCallsOfTenBytes));
}

TEST(HeldCalls, BytesAreLimitedButASingleCallIsPermitted) {
  HeldCalls calls;
  EXPECT_OK(calls.Begin("ann", 11, kTwoCallsOfTenBytes));
  EXPECT_OK(calls.CheckRoom("ann", kTwoCallsOfTenBytes));
  const absl::Status second = calls.Begin("ann", 1, kTwoCallsOfTenBytes);
  EXPECT_THAT(std::string(second.message()), HasSubstr("10 (--max-call-bytes-per-principal)"));
  calls.End("ann", 11);
  EXPECT_OK(calls.Begin("ann", 5, kTwoCallsOfTenBytes));
  EXPECT_OK(calls.Begin("ann", 5, kTwoCallsOfTenBytes));
  EXPECT_OK(calls.CheckRoom("ann", kTwoCallsOfTenBytes));
  calls.AddBytes("ann", 1);  // an answer
  EXPECT_THAT(calls.CheckRoom("ann", kTwoCallsOfTenBytes),
              StatusIs(absl::StatusCode::kResourceExhausted));
}

TEST(HeldCalls, ZeroMeansUnlimited) {
  HeldCalls calls;
  const Limits none = {.max_calls_per_principal = 0, .max_call_bytes_per_principal = 0};
  for (int i = 0; i < 2000; ++i) EXPECT_OK(calls.Begin("ann", 1 << 30, none));
  EXPECT_OK(calls.CheckRoom("ann", none));
}

TEST(HeldCalls, AMessageWaitsUntilThereIsRoom) {
  HeldCalls messages;
  EXPECT_TRUE(messages.TryBegin("ann", 12, 10));  // alone
  EXPECT_FALSE(messages.TryBegin("ann", 1, 10));
  EXPECT_TRUE(messages.TryBegin("bob", 1, 10));
  messages.End("ann", 12);
  EXPECT_TRUE(messages.TryBegin("ann", 4, 10));
  EXPECT_TRUE(messages.TryBegin("ann", 6, 10));
  EXPECT_FALSE(messages.TryBegin("ann", 1, 10));
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
