#include <sys/socket.h>
#include <sys/un.h>

#include "tests/fault/store/fault_disk.h"
#include "tests/server/http_get.h"
#include "tests/server/preamble.h"
#include "tests/server/secure_server.h"

namespace ballpiston::server {
namespace {

// Expects that a server with these options does not start, and that the error is one line.
void ExpectStartRefused(const TestServerOptions& options, const std::string& why,
                        absl::StatusCode code = absl::StatusCode::kUnavailable) {
  const absl::Status error = StartError(options);
  EXPECT_THAT(error, StatusIs(code, AllOf(HasSubstr(why), Not(HasSubstr("\n")))));
}

TEST(StartStop, APortOrADataFolderInUseIsRefused) {
  const TemporaryFolder folder;
  {
    RunningServer server({.data_dir = folder.path(), .listen = "127.0.0.1:0"});
    EXPECT_THAT(server.address(), Not(EndsWith(":0")));  // it has the chosen port
    EXPECT_OK(CallByName(server.channel(), kCheckHealth));
    ExpectStartRefused({.listen = server.address()}, server.address());
    ExpectStartRefused({.listen = server.address()}, "in use");
    ExpectStartRefused({.data_dir = folder.path(), .listen = "127.0.0.1:0"},
                       "in use by another ballpistond, which listens on " + server.address() + ";",
                       absl::StatusCode::kFailedPrecondition);
    EXPECT_TRUE(std::filesystem::exists(folder.File("server.address")));  // of the first server
  }
  EXPECT_FALSE(std::filesystem::exists(folder.File("server.address")));
}

TEST(StartStop, AServerThatCannotListenDoesNotTouchItsClustersFolder) {
  const TemporaryFolder folder;
  RunningServer other({.listen = "127.0.0.1:0"});
  ExpectStartRefused(
      {.listen = other.address(), .cluster = ClusterOptions{.folder = folder.path()}}, "in use");
  EXPECT_THAT(NamesIn(folder.path()), IsEmpty());
}

TEST(StartStop, OtherFilesAtASocketsPathStay) {
  const TemporaryFolder folder;
  const std::string precious = folder.File("precious"), datagrams = folder.File("datagrams");
  WriteFile(precious, "x");
  ExpectStartRefused({.listen = "unix:" + precious}, "choose another address");
  EXPECT_EQ(Contents(precious), "x");
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un local{.sun_family = AF_UNIX, .sun_path = {}};
  datagrams.copy(local.sun_path, sizeof(local.sun_path) - 1);
  ASSERT_EQ(bind(descriptor, reinterpret_cast<const sockaddr*>(&local), sizeof(local)), 0);
  ExpectStartRefused({.listen = "unix:" + datagrams}, "choose another path");
  EXPECT_TRUE(std::filesystem::exists(datagrams));
  close(descriptor);
}

// A server that waited for these clients would stop after the time to drain, which is long. The
// server drops two blocks that never end, and begins no other block.
TEST(StartStop, HungClientsAndEndlessBlocksDoNotDelayAStop) {
  const LaboratoryFiles files;
  Gate gate;
  std::atomic<int> begun = 0;
  RunningServer server(
      Secure(files, {.factory = FakeExperiments([&](size_t, uint64_t, std::stop_token stop) {
                       ++begun;
                       gate.Pass(stop);
                     }),
                     .credentials = files.Credentials(kAlice)}));
  v1::WatchEnsembleJobRequest request;
  request.set_name(server.Submit(Equilibrium(1000, 1)));
  gate.AwaitWaiting(2);
  const Connection no_handshake(server.address());
  Connection half_a_handshake(server.address());
  half_a_handshake.Send("\x16\x03\x01");
  const SilentTlsConnection silent(server.address());
  EXPECT_EQ(silent.served_common_name(), "server-1");
  NamedCall watch(server.channel(), kWatchJob);
  watch.Send(request.SerializeAsString());
  NamedCall health(server.channel(), kWatchHealth);
  health.Send(kWholeServer);
  const NamedCall without_message(server.channel(), kGetJob);
  server.Shutdown(kUnreachedLimit);
  EXPECT_THAT(CallByName(server.channel(), kCheckHealth), StatusIs(grpc::StatusCode::UNAVAILABLE));
  EXPECT_EQ(begun, 2);
  EXPECT_EQ(gate.waiting(), 0);
}

TEST(StartStop, AServerWithoutCallsAndJobsIsIdle) {
  Gate gate;
  RunningServer server({.factory = GatedExperiments(gate)});
  const std::string name = server.Submit(Equilibrium(1, 5));
  gate.AwaitWaiting(1);
  EXPECT_EQ(server.server().IdleFor().count(), 0);  // the server computes
  gate.Open();
  server.AwaitEnd(name);
  AwaitThat([&] { return server.server().IdleFor() >= std::chrono::milliseconds(1); });
}

// grpc.health.v1 by hand: the request's field 1 names a service, an empty one asks for the whole
// server; the answer's field 1 is the state, 1 for SERVING.
std::string HealthOf(RunningServer& server, const std::string& service) {
  const std::string name =
      service.empty() ? "" : std::string{'\x0a', static_cast<char>(service.size())} + service;
  std::string answer;
  EXPECT_OK(CallByName(server.channel(), kCheckHealth, name, {}, &answer));
  return answer;
}

constexpr char kServing[] = "\x08\x01";

// A call that waited for the disk would keep its thread.
TEST(StartStop, WhileTheDiskHangsCallsThatWriteAreRefusedAndReadsAnswered) {
  FaultDisk disk;
  std::atomic<bool> hangs = false;
  disk.SetBeforeOperation([&hangs] { hangs.wait(true); });
  RunningServer server({.store = {.stall = std::chrono::milliseconds(1)}});
  const auto is_serving = [&] {
    return HealthOf(server, "ballpiston.v1.EnsembleService") == kServing;
  };
  AwaitThat(is_serving);
  hangs = true;
  const auto waiting = std::async([&] { server.Call(CreateRequest(Equilibrium(1, 1))); });
  AwaitThat([&] { return !is_serving(); });
  for (const char* service : {"", "ballpiston.v1.AnalyticService", "ballpiston.v1.TraceService",
                              "ballpiston.v1.ServerService"}) {
    EXPECT_EQ(HealthOf(server, service), kServing) << service;
  }
  EXPECT_EQ(server.Status().state(), v1::ServerStatus::STORE_FAILING);
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(server.Call(CreateRequest(Equilibrium(1, 1))),
                IsError(grpc::StatusCode::UNAVAILABLE, "STORE_FAILED"));
    EXPECT_EQ(server.List().jobs_size(), 0);
  }
  hangs = false;
  hangs.notify_all();
  AwaitThat(is_serving);
}

}  // namespace
}  // namespace ballpiston::server
