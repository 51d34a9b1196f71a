// A watch lives no longer than the credentials it was begun with.
#include <memory>
#include <string>

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.grpc.pb.h"
#include "gtest/gtest.h"
#include "server/security/access_entry.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/running_server.h"
#include "tests/server/secure_server.h"

namespace ballpiston::server {
namespace {

std::string Line(const char* token, const Principal& principal,
                 absl::Time expires = absl::InfiniteFuture()) {
  return FormatAccessEntry({HashOf(token), principal, expires}) + "\n";
}

class WatchCredentialsTest : public testing::Test {
 protected:
  struct Stream {
    Stream(v1::EnsembleService::Stub& stub, const char* token, const std::string& name) {
      context.AddMetadata("authorization", std::string("Bearer ") + token);
      v1::WatchEnsembleJobRequest request;
      request.set_name(name);
      reader = stub.WatchEnsembleJob(&context, request);
    }
    grpc::Status End() {
      while (reader->Read(&message)) {
      }
      return reader->Finish();
    }

    grpc::ClientContext context;
    v1::WatchEnsembleJobResponse message;
    std::unique_ptr<grpc::ClientReader<v1::WatchEnsembleJobResponse>> reader;
  };

  ~WatchCredentialsTest() override { gate_.Open(); }

  std::unique_ptr<BallpistonServer> Start() {
    ServerOptions options = SecureOptions(files_.options(), folder_.path());
    options.factory =
        FakeExperiments([this](size_t, uint64_t, std::stop_token stop) { gate_.Pass(stop); });
    options.watch.heartbeat = std::chrono::milliseconds(20);
    return *BallpistonServer::Start(options);
  }

  // A job of alice's that waits.
  std::string JobOfAlice(const v1::EnsembleSpec& spec = Equilibrium(1, 2)) {
    grpc::ClientContext context;
    context.AddMetadata("authorization", std::string("Bearer ") + kAlice);
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = spec;
    v1::EnsembleJob job;
    const grpc::Status created = stub_->CreateEnsembleJob(&context, request, &job);
    EXPECT_TRUE(created.ok()) << created.error_message();
    return job.name();
  }

  void ReplaceAccess(const std::string& lines) {
    files_.WriteAccessFile(lines);
    ASSERT_TRUE(server_->Reload().ok());
  }

  double Streams() {
    grpc::ClientContext context;
    context.AddMetadata("authorization", std::string("Bearer ") + kOps);
    v1::ServerStatus status;
    const auto stub = v1::ServerService::NewStub(channel_);
    EXPECT_TRUE(stub->GetServerStatus(&context, {}, &status).ok());
    return status.streams();
  }

  Gate gate_;
  LaboratoryFiles files_;
  TemporaryFolder folder_;
  std::unique_ptr<BallpistonServer> server_ = Start();
  std::shared_ptr<grpc::Channel> channel_ =
      SecureChannel(server_->address(), files_.authority().Pem());
  std::unique_ptr<v1::EnsembleService::Stub> stub_ = v1::EnsembleService::NewStub(channel_);
};

TEST_F(WatchCredentialsTest, AWatchEndsWhenItsTokenIsTakenAway) {
  Stream watch(*stub_, kAlice, JobOfAlice());
  ASSERT_TRUE(watch.reader->Read(&watch.message));
  ReplaceAccess(Line(kOps, {"ops", Role::kAdmin}));
  const grpc::Status end = watch.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(DetailsOf(end).reason, "CREDENTIALS_INVALID");
}

TEST_F(WatchCredentialsTest, AWatchEndsWhenItsTokenExpires) {
  Stream watch(*stub_, kAlice, JobOfAlice());
  ASSERT_TRUE(watch.reader->Read(&watch.message));
  ReplaceAccess(Line(kAlice, {"alice", Role::kSubmit}, absl::FromUnixSeconds(1'000'000'000)));
  const grpc::Status end = watch.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(DetailsOf(end).reason, "CREDENTIALS_EXPIRED");
}

TEST_F(WatchCredentialsTest, ATokenThatIsNowSomebodyElsesIsNotEnough) {
  Stream watch(*stub_, kAlice, JobOfAlice());
  ASSERT_TRUE(watch.reader->Read(&watch.message));
  ReplaceAccess(Line(kAlice, {"bob", Role::kAdmin}));
  EXPECT_EQ(DetailsOf(watch.End()).reason, "CREDENTIALS_INVALID");
}

TEST_F(WatchCredentialsTest, WhoIsNoAdministratorAnyMoreSeesNoOthersJob) {
  const std::string name = JobOfAlice();
  Stream watch(*stub_, kOps, name);
  ASSERT_TRUE(watch.reader->Read(&watch.message));
  ReplaceAccess(Line(kOps, {"ops", Role::kSubmit}) + Line(kAlice, {"alice", Role::kRead}));
  const grpc::Status end = watch.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(DetailsOf(end).reason, "JOB_NOT_FOUND");
}

TEST_F(WatchCredentialsTest, AWatchWhoseTokenHoldsGoesOn) {
  Stream watch(*stub_, kAlice, JobOfAlice());
  ReplaceAccess(LaboratoryTokens());
  for (int beats = 0; beats < 3; beats += watch.message.has_heartbeat()) {
    ASSERT_TRUE(watch.reader->Read(&watch.message));
  }
}

TEST_F(WatchCredentialsTest, AReaderThatHasStalledIsSentAwayToo) {
  v1::EnsembleSpec large = Equilibrium(0, 1);
  for (int i = 0; i < 90'000; ++i) large.mutable_grid()->add_delta(0.1 + 1e-7 * i);  // 720 kB
  Stream stalled(*stub_, kAlice, JobOfAlice(large));
  while (Streams() < 1) {  // until it is there
  }
  ReplaceAccess(Line(kOps, {"ops", Role::kAdmin}));
  while (Streams() > 0) {
  }
}

}  // namespace
}  // namespace ballpiston::server
