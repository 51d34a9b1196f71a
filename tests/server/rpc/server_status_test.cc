// The objects behind the API, without gRPC, so that a test can set the caller.
#include "server/rpc/server_status.h"

#include "grpcpp/test/server_context_test_spouse.h"
#include "prometheus/text_serializer.h"
#include "server/rpc/call.h"
#include "server/rpc/methods.h"
#include "tests/server/book/book_test.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

class ServerStatusTest : public BookTest {
 protected:
  // Creates a job that waits at the gate.
  void Submit(const std::string& principal) {
    Id({principal, Role::kSubmit}, FreshRequest(Equilibrium(1, 100, kHeldSeed)));
  }

  v1::ServerStatus AskedBy(const std::string& principal, Role role) {
    const Call call{.method = "GetServerStatus", .caller = {principal, role}};
    return GetServerStatus(context_, call, v1::GetServerStatusRequest()).value();
  }

  std::string Metrics(std::optional<absl::Time> expiry = std::nullopt) {
    return prometheus::TextSerializer().Serialize(ServerMetrics(context_, expiry));
  }

  Authenticator authenticator_{/*needs_tokens=*/false};
  ModelLadder ladder_{2};
  Quotas quotas_{limits_};
  std::atomic<bool> draining_ = false;
  Streams streams_{authenticator_, std::chrono::seconds(10), draining_};
  CallObserver calls_;
  ServiceContext context_{.authenticator = authenticator_,
                          .limits = limits_,
                          .book = *book_,
                          .scheduler = pool_->scheduler(),
                          .threads = pool_->threads(),
                          .cluster = nullptr,
                          .ladder = ladder_,
                          .quotas = quotas_,
                          .streams = streams_,
                          .draining = draining_,
                          .instance = "test",
                          .timing = {},
                          .store = *store_,
                          .calls = calls_,
                          .start_time = absl::FromUnixMicros(1'700'000'000'250'000),
                          .store_path = path_};
};

TEST_F(ServerStatusTest, AnExceptionEndsTheCallOnly) {
  grpc::ServerContext context;
  EXPECT_THAT(ServeCall(context_, context, {"EvaluatePairs", Role::kRead},
                        [](const Call&) -> absl::Status { throw std::runtime_error("no memory"); }),
              IsError(grpc::StatusCode::INTERNAL, "INTERNAL"));
}

// gRPC's own retries obey the metadata.
TEST_F(ServerStatusTest, ATemporaryLimitSaysWhenToRetry) {
  const auto metadata = [this](const char* reason) {
    grpc::ServerContext context;
    ServeCall(context_, context, {"CreateEnsembleJob", Role::kSubmit},
              [&](const Call&) { return LimitExceeded(reason, "it", "flag", 1); });
    return grpc::testing::ServerContextTestSpouse(&context).GetTrailingMetadata();
  };
  EXPECT_THAT(metadata("TOO_MANY_JOBS"), ElementsAre(Pair("grpc-retry-pushback-ms", "10000")));
  EXPECT_THAT(metadata("TOO_MANY_POINTS"), IsEmpty());
}

TEST_F(ServerStatusTest, CountsQueuedAndRunningWorkOfEachPrincipal) {
  limits_ = {.max_active_jobs_per_principal = 7,
             .max_active_points_per_principal = 72,
             .max_streams_per_principal = 73,
             .retain_days = 74};
  Submit("alice");
  gate_.AwaitWaiting(2);
  Submit("bob");
  const auto stream = quotas_.streams.Take("alice");
  v1::ServerStatus status = AskedBy("root", Role::kAdmin);
  EXPECT_GT(status.store_bytes(), 4096);
  EXPECT_GT(status.rates().wall_hit(), 0);
  EXPECT_GT(status.rates().jump(), 0);
  EXPECT_EQ(status.engine_version(), EngineVersion());
  for (const char* measured :
       {"version", "engine_version", "store_bytes", "rates", "processor_seconds"}) {
    status.GetReflection()->ClearField(&status, status.GetDescriptor()->FindFieldByName(measured));
  }
  for (v1::PrincipalStatus& principal : *status.mutable_principals()) {
    EXPECT_GT(principal.stored_bytes(), 0);
    principal.clear_stored_bytes();
  }
  EXPECT_EQ(
      status.ShortDebugString(),
      R"(state: SERVING start_time { seconds: 1700000000 nanos: 250000000 } workers: 2 )"
      R"(busy_workers: 2 queued_jobs: 1 running_jobs: 1 streams: 1 stored_jobs: 2 )"
      R"(limits { max_points_per_job: 100000 max_active_jobs_per_principal: 7 )"
      R"(max_active_points_per_principal: 72 max_streams_per_principal: 73 retain_days: 74 } )"
      R"(principal: "root" role: "admin" )"
      R"(principals { principal: "alice" running_jobs: 1 streams: 1 stored_jobs: 1 } )"
      R"(principals { principal: "bob" queued_jobs: 1 stored_jobs: 1 })");
  for (const char* gauge :
       {"jobs{state=\"running\"} 1", "jobs{state=\"queued\"} 1", "busy_workers 2", "streams 1"}) {
    EXPECT_THAT(Metrics(), HasSubstr(absl::StrCat("\nballpiston_", gauge, "\n")));
  }
  draining_ = true;
  EXPECT_EQ(AskedBy("root", Role::kAdmin).state(), v1::ServerStatus::DRAINING);
}

TEST_F(ServerStatusTest, OnlyAnAdministratorSeesOtherPrincipals) {
  for (const char* principal : {"alice", "bob"}) Submit(principal);
  for (const Role role : {Role::kRead, Role::kSubmit}) {
    const v1::ServerStatus own = AskedBy("alice", role);
    ASSERT_EQ(own.principals_size(), 1);
    EXPECT_EQ(own.principals(0).principal(), "alice");
    EXPECT_THAT(own.DebugString(), Not(HasSubstr("bob")));
    EXPECT_EQ(own.queued_jobs() + own.running_jobs(), 2);  // of all principals
    EXPECT_EQ(own.stored_jobs(), 2);
  }
  EXPECT_EQ(AskedBy("carol", Role::kSubmit).principals_size(), 0);
}

TEST_F(ServerStatusTest, TheExpiryOfACertificateIsAMetricIfThereIsOne) {
  constexpr char kExpiry[] = "ballpiston_certificate_expiry_timestamp_seconds";
  EXPECT_THAT(Metrics(), Not(HasSubstr(kExpiry)));
  EXPECT_THAT(Metrics(absl::FromUnixSeconds(2'000'000'000)),
              HasSubstr(absl::StrCat("\n", kExpiry, " 2000000000\n")));
}

// An abandoned plan would keep its thread and a processor.
TEST_F(ServerStatusTest, APlanEndsWhenItsClientHasLeft) {
  v1::PlanEnsembleJobRequest request;
  *request.mutable_spec() = Equilibrium(10, 100);
  int asked = 0;
  const Call call{
      .method = "PlanEnsembleJob", .caller = kAnn, .is_abandoned = [&] { return ++asked == 3; }};
  EXPECT_THAT(PlanEnsembleJob(context_, call, request), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_EQ(asked, 3);
}

}  // namespace
}  // namespace ballpiston::server
