#include "server/rpc/server_status.h"

#include "grpcpp/test/server_context_test_spouse.h"
#include "prometheus/text_serializer.h"
#include "server/rpc/call.h"
#include "server/rpc/methods.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// The objects behind the API, without gRPC, so that a test can set the caller.
class ServerStatusTest : public testing::Test {
 protected:
  ~ServerStatusTest() override { gate_.Open(); }

  void Submit(const std::string& principal, int points = 1) {
    const v1::CreateEnsembleJobRequest request = FreshRequest(Equilibrium(points, 100));
    ASSERT_OK(book_.Create({principal, Role::kSubmit}, request, CheckSpec(request.spec())));
  }

  v1::ServerStatus AskedBy(const std::string& principal, Role role) {
    const Call call{.method = "GetServerStatus", .caller = {principal, role}};
    const auto status = GetServerStatus(context_, call, v1::GetServerStatusRequest());
    EXPECT_OK(status);
    return *status;
  }

  std::string Metrics(std::optional<absl::Time> expiry = std::nullopt) {
    return prometheus::TextSerializer().Serialize(ServerMetrics(context_, expiry));
  }

  TemporaryFolder folder_;
  Gate gate_;
  const Limits limits_ = {.max_active_jobs_per_principal = 7,
                          .max_active_points_per_principal = 72,
                          .max_streams_per_principal = 73};
  Authenticator authenticator_{/*needs_tokens=*/false};
  std::unique_ptr<Store> store_ =
      *Store::Open(folder_.File("store.sqlite3"), {.stall = kUnreachedLimit});
  ModelLadder ladder_{2};
  ThreadPool pool_{
      2, FakeExperiments([this](size_t, uint64_t, std::stop_token stop) { gate_.Pass(stop); })};
  JobBook book_{*store_, limits_, pool_.scheduler()};
  Quotas quotas_{limits_};
  std::atomic<bool> draining_ = false;
  Streams streams_{authenticator_, std::chrono::seconds(10), draining_};
  CallObserver calls_;
  ServiceContext context_{.authenticator = authenticator_,
                          .limits = limits_,
                          .book = book_,
                          .scheduler = pool_.scheduler(),
                          .threads = pool_.threads(),
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
                          .store_path = folder_.File("store.sqlite3")};
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

TEST_F(ServerStatusTest, CountsQueuedAndRunningWork) {
  Submit("alice");
  gate_.AwaitWaiting(2);
  Submit("bob");
  const auto stream = quotas_.streams.Take("alice");
  const v1::ServerStatus status = AskedBy("root", Role::kAdmin);
  EXPECT_EQ(status.state(), v1::ServerStatus::SERVING);
  EXPECT_EQ(status.start_time().seconds(), 1'700'000'000);
  EXPECT_EQ(status.start_time().nanos(), 250'000'000);
  EXPECT_EQ(status.workers(), 2);
  EXPECT_EQ(status.busy_workers(), 2);
  EXPECT_EQ(status.running_jobs(), 1);
  EXPECT_EQ(status.queued_jobs(), 1);
  EXPECT_EQ(status.streams(), 1);
  for (const char* gauge :
       {"jobs{state=\"running\"} 1", "jobs{state=\"queued\"} 1", "busy_workers 2", "streams 1"}) {
    EXPECT_THAT(Metrics(), HasSubstr(absl::StrCat("\nballpiston_", gauge, "\n")));
  }
  EXPECT_EQ(status.stored_jobs(), 2);
  EXPECT_GT(status.store_bytes(), 4096);
  EXPECT_GT(status.rates().wall_hit(), 0);
  EXPECT_GT(status.rates().jump(), 0);
  EXPECT_EQ(status.limits().max_active_jobs_per_principal(), 7);
  EXPECT_EQ(status.limits().max_active_points_per_principal(), 72);
  EXPECT_EQ(status.limits().max_streams_per_principal(), 73);
  EXPECT_EQ(status.engine_version(), EngineVersion());
  draining_ = true;
  EXPECT_EQ(AskedBy("root", Role::kAdmin).state(), v1::ServerStatus::DRAINING);
}

TEST_F(ServerStatusTest, OnlyAnAdministratorSeesOtherPrincipals) {
  Submit("alice");
  gate_.AwaitWaiting(2);
  Submit("bob");
  Submit("bob");
  const v1::ServerStatus all = AskedBy("root", Role::kAdmin);
  EXPECT_EQ(all.principal(), "root");
  EXPECT_EQ(all.role(), "admin");
  ASSERT_EQ(all.principals_size(), 2);
  EXPECT_EQ(all.principals(0).principal(), "alice");
  EXPECT_EQ(all.principals(0).running_jobs(), 1);
  EXPECT_EQ(all.principals(1).principal(), "bob");
  EXPECT_EQ(all.principals(1).queued_jobs(), 2);

  for (const Role role : {Role::kRead, Role::kSubmit}) {
    const v1::ServerStatus own = AskedBy("alice", role);
    ASSERT_EQ(own.principals_size(), 1);
    EXPECT_EQ(own.principals(0).principal(), "alice");
    EXPECT_EQ(own.DebugString().find("bob"), std::string::npos);
    EXPECT_EQ(own.queued_jobs(), 2);  // of all principals, because they share the queue
  }
  EXPECT_EQ(AskedBy("carol", Role::kSubmit).principals_size(), 0);
}

TEST_F(ServerStatusTest, TheExpiryOfACertificateIsAMetricIfThereIsOne) {
  constexpr char kExpiry[] = "ballpiston_certificate_expiry_timestamp_seconds";
  EXPECT_THAT(Metrics(), testing::Not(testing::HasSubstr(kExpiry)));
  EXPECT_THAT(Metrics(absl::FromUnixSeconds(2'000'000'000)),
              testing::HasSubstr(absl::StrCat("\n", kExpiry, " 2000000000\n")));
}

// An abandoned plan would keep its thread and a processor.
TEST_F(ServerStatusTest, APlanEndsWhenItsClientHasLeft) {
  v1::PlanEnsembleJobRequest request;
  *request.mutable_spec() = Equilibrium(10, 100);
  int asked = 0;
  const Call call{.method = "PlanEnsembleJob", .caller = {"ann", Role::kRead}, .is_abandoned = [&] {
                    return ++asked == 3;
                  }};
  EXPECT_THAT(PlanEnsembleJob(context_, call, request), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_EQ(asked, 3);
}

}  // namespace
}  // namespace ballpiston::server
