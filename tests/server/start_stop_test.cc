#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <thread>

#include "gmock/gmock.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/generic/generic_stub.h"
#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

ServerOptions Options(const std::string& data_dir, const std::string& listen = "") {
  ServerOptions options;
  options.data_dir = data_dir;
  options.listen = listen;
  options.factory = FakeExperiments();
  return options;
}

std::string FailureOf(const ServerOptions& options) {
  const auto server = BallpistonServer::Start(options);
  EXPECT_FALSE(server.ok());
  EXPECT_THAT(std::string(server.status().message()), testing::Not(HasSubstr("\n")));
  return std::string(server.status().message());
}

TEST(StartStop, ThePortThatWasChosenIsTold) {
  TemporaryFolder folder;
  RunningServer server(Options(folder.path(), "127.0.0.1:0"));
  EXPECT_THAT(server.server().address(), testing::Not(HasSubstr(":0")));
  server.Submit(Equilibrium(1, 2));
}

TEST(StartStop, APortInUseIsRefused) {
  TemporaryFolder first, second;
  RunningServer server(Options(first.path(), "127.0.0.1:0"));
  const std::string failure = FailureOf(Options(second.path(), server.server().address()));
  EXPECT_THAT(failure, HasSubstr(server.server().address()));
  EXPECT_THAT(failure, HasSubstr("in use"));
}

TEST(StartStop, ADataFolderInUseIsRefused) {
  TemporaryFolder folder;
  {
    RunningServer server(Options(folder.path()));
    EXPECT_THAT(FailureOf(Options(folder.path(), "127.0.0.1:0")),
                HasSubstr("in use by another ballpistond, which listens on " +
                          server.server().address() + ";"));
    EXPECT_TRUE(std::filesystem::exists(folder.File("server.address")));  // still that one's
  }
  EXPECT_FALSE(std::filesystem::exists(folder.File("server.address")));
}

TEST(StartStop, ASocketThatAnotherServerListensOnIsRefused) {
  TemporaryFolder first, second;
  RunningServer server(Options(first.path()));
  EXPECT_THAT(FailureOf(Options(second.path(), server.server().address())),
              HasSubstr("a server is listening there"));
  server.Submit(Equilibrium(1, 2));  // it still can be reached
}

TEST(StartStop, AStaleSocketIsReplacedAndTheNewOneIsItsOwners) {
  TemporaryFolder folder;
  const std::string stale = folder.File("server.socket");
  { RunningServer server(Options(folder.path())); }
  ASSERT_EQ(mknod(stale.c_str(), S_IFSOCK | 0777, 0), 0);
  RunningServer server(Options(folder.path()));
  server.Submit(Equilibrium(1, 2));
  struct stat found {};
  ASSERT_EQ(stat(stale.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0600u);
}

TEST(StartStop, ADamagedStoreIsRefused) {
  TemporaryFolder folder;
  std::ofstream(folder.File("store.sqlite3")) << std::string(10'000, 'x');
  EXPECT_THAT(FailureOf(Options(folder.path())), HasSubstr("damaged"));
}

TEST(StartStop, StoppingDoesNotWaitForAnEndlessBlock) {
  TemporaryFolder folder;
  Gate gate;
  ServerOptions options = Options(folder.path());
  options.workers = 3;
  options.factory =
      FakeExperiments([&](size_t, uint64_t, std::stop_token stop) { gate.Pass(stop); });
  RunningServer server(options);
  server.Submit(Equilibrium(5, 100));
  gate.AwaitWaiting(3);
  server.server().Shutdown(std::chrono::seconds(10));
}

TEST(StartStop, AServerWithoutCallsAndJobsIsIdle) {
  TemporaryFolder folder;
  Gate gate;
  ServerOptions options = Options(folder.path());
  options.factory =
      FakeExperiments([&](size_t, uint64_t, std::stop_token stop) { gate.Pass(stop); });
  RunningServer server(options);
  const std::string name = server.Submit(Equilibrium(1, 5));
  gate.AwaitWaiting(1);
  EXPECT_EQ(server.server().IdleFor().count(), 0);  // it computes
  gate.Open();
  server.AwaitEnd(name);
  while (server.server().IdleFor() < std::chrono::milliseconds(1)) std::this_thread::yield();
}

// grpc.health.v1 by hand: the request's field 1 names a service, an empty one asks for the whole
// server; the answer's field 1 is the state, 1 for SERVING.
std::string HealthOf(RunningServer& server, const std::string& service) {
  const std::string name =
      service.empty() ? "" : std::string{'\x0a', static_cast<char>(service.size())} + service;
  grpc::GenericStub stub(server.channel());
  const grpc::Slice asked(name);
  grpc::ByteBuffer request(&asked, 1), response;
  grpc::ClientContext context;
  std::promise<grpc::Status> done;
  stub.UnaryCall(&context, "/grpc.health.v1.Health/Check", {}, &request, &response,
                 [&](grpc::Status status) { done.set_value(std::move(status)); });
  const grpc::Status status = done.get_future().get();
  EXPECT_TRUE(status.ok()) << status.error_message();
  grpc::Slice slice;
  EXPECT_TRUE(response.TrySingleSlice(&slice).ok());
  return std::string(slice.begin(), slice.end());
}

TEST(StartStop, HealthIsServedForTheWholeAndForEachService) {
  TemporaryFolder folder;
  RunningServer server(Options(folder.path()));
  for (const char* service : {"", "ballpiston.v1.EnsembleService", "ballpiston.v1.AnalyticService",
                              "ballpiston.v1.MethodService", "ballpiston.v1.ServerService"}) {
    EXPECT_EQ(HealthOf(server, service), "\x08\x01") << service;
  }
}

}  // namespace
}  // namespace ballpiston::server
