// What calls hold whose answers nobody reads, by itself and through the API.
#include "server/api/held_calls.h"

#include <memory>
#include <stop_token>
#include <string>

#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/running_server.h"
#include "tests/server/temporary_folder.h"
#include "tests/server/unread_call.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

constexpr Limits kTwoCallsOfTenBytes = {.max_calls_per_principal = 2,
                                        .max_call_bytes_per_principal = 10};

TEST(HeldCalls, APrincipalsCallsAreItsOwn) {
  HeldCalls calls;
  EXPECT_TRUE(calls.Begin("ann", 1, kTwoCallsOfTenBytes).ok());
  EXPECT_TRUE(calls.Begin("ann", 1, kTwoCallsOfTenBytes).ok());
  const absl::Status third = calls.Begin("ann", 1, kTwoCallsOfTenBytes);
  EXPECT_TRUE(absl::IsResourceExhausted(third));
  EXPECT_THAT(std::string(third.message()), HasSubstr("permits 2 (--max-calls-per-principal)"));
  EXPECT_TRUE(calls.Begin("bob", 1, kTwoCallsOfTenBytes).ok());
  calls.End("ann", 1);
  EXPECT_TRUE(calls.Begin("ann", 1, kTwoCallsOfTenBytes).ok());
}

TEST(HeldCalls, SoAreTheirBytesAndOneAloneMayHaveAnyNumber) {
  HeldCalls calls;
  EXPECT_TRUE(calls.Begin("ann", 11, kTwoCallsOfTenBytes).ok());
  EXPECT_TRUE(calls.CheckRoom("ann", kTwoCallsOfTenBytes).ok());
  const absl::Status second = calls.Begin("ann", 1, kTwoCallsOfTenBytes);
  EXPECT_THAT(std::string(second.message()), HasSubstr("10 (--max-call-bytes-per-principal)"));
  calls.End("ann", 11);
  EXPECT_TRUE(calls.Begin("ann", 5, kTwoCallsOfTenBytes).ok());
  EXPECT_TRUE(calls.Begin("ann", 5, kTwoCallsOfTenBytes).ok());
  EXPECT_TRUE(calls.CheckRoom("ann", kTwoCallsOfTenBytes).ok());
  calls.AddBytes("ann", 1);  // an answer
  EXPECT_TRUE(absl::IsResourceExhausted(calls.CheckRoom("ann", kTwoCallsOfTenBytes)));
}

TEST(HeldCalls, ZeroIsNoLimit) {
  HeldCalls calls;
  const Limits none = {.max_calls_per_principal = 0, .max_call_bytes_per_principal = 0};
  for (int i = 0; i < 2000; ++i) EXPECT_TRUE(calls.Begin("ann", 1 << 30, none).ok());
  EXPECT_TRUE(calls.CheckRoom("ann", none).ok());
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

class UnreadAnswers : public testing::Test {
 protected:
  ~UnreadAnswers() override { gate_.Open(); }

  // A server with a job whose message is more than a connection takes in.
  RunningServer& Start(const Limits& limits) {
    ServerOptions options;
    options.data_dir = folder_.File("data");
    options.factory =
        FakeExperiments([this](size_t, uint64_t, std::stop_token stop) { gate_.Pass(stop); });
    options.limits = limits;
    server_ = std::make_unique<RunningServer>(options);
    v1::EnsembleSpec large = Equilibrium(0, 1);
    for (int i = 0; i < 90'000; ++i) large.mutable_grid()->add_delta(0.1 + 1e-7 * i);
    name_ = server_->Submit(large);
    return *server_;
  }

  grpc::Status Evaluate() {
    grpc::ClientContext context;
    v1::EvaluatePairsResponse response;
    return server_->analytic().EvaluatePairs(&context, {}, &response);
  }

  std::unique_ptr<UnreadCall> Unread() {
    v1::GetEnsembleJobRequest request;
    request.set_name(name_);
    auto call = std::make_unique<UnreadCall>(server_->channel(),
                                             "/ballpiston.v1.EnsembleService/GetEnsembleJob");
    call->Send(request.SerializeAsString());
    call->AwaitAnswer();
    return call;
  }

  void ExpectRefusedUntilLetGo(const std::string& flag) {
    std::unique_ptr<UnreadCall> unread;
    grpc::Status refused;
    do {  // until the server knows that the answers before it were read
      unread = Unread();
      refused = Evaluate();
    } while (DetailsOf(refused).reason != "TOO_MANY_CALLS");
    EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(refused.error_message(), HasSubstr("(--" + flag + ")"));
    unread.reset();
    while (DetailsOf(Evaluate()).reason == "TOO_MANY_CALLS") {  // until the server has heard of it
    }
  }

  Gate gate_;
  TemporaryFolder folder_;
  std::unique_ptr<RunningServer> server_;
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
