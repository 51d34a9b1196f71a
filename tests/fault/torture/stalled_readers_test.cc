// Readers that stall take bounded memory in the server, and do not delay its stop. They are a
// process that opens watches and then stops (SIGSTOP): neither the watches nor gRPC read what the
// server sends. The test program itself is that process if its first argument says so.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/server/own_channel.h"
#include "tests/support/process.h"
#include "tests/support/run_tests.h"

namespace ballpiston::torture {
namespace {

constexpr char kReadersFlag[] = "--stalled_readers";  // COUNT ADDRESS JOB
constexpr double kMostMiB = 64;                       // of all readers
constexpr int kPoints = 20'000;  // some MB for each watch, far more than gRPC holds

// A watch with a connection of its own.
struct StalledReader {
  StalledReader(const std::string& address, const std::string& job)
      : stub(v1::EnsembleService::NewStub(
            server::OwnChannel(address, nullptr, server::SmallWindow()))) {
    v1::WatchEnsembleJobRequest request;
    request.set_name(job);
    stream = stub->WatchEnsembleJob(&context, request);
    stream->WaitForInitialMetadata();  // the first message is on its way
  }

  std::unique_ptr<v1::EnsembleService::Stub> stub;
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<v1::WatchEnsembleJobResponse>> stream;
};

[[noreturn]] void RunStalledReaders(int count, const std::string& address, const std::string& job) {
  std::vector<std::unique_ptr<StalledReader>> readers;
  for (int i = 0; i < count; ++i) {
    readers.push_back(std::make_unique<StalledReader>(address, job));
  }
  raise(SIGSTOP);
  std::_Exit(0);
}

// Waits until the server has used no processor time for a while: it has sent what it can.
void AwaitQuiet(const ConnectedServer& server) {
  int quiet = 0;
  double before = server.ProcessorSeconds();
  AwaitThat([&] {
    const double now = server.ProcessorSeconds();
    quiet = now - before < 1e-3 ? quiet + 1 : 0;
    if (quiet == 0) before = now;
    return quiet == 200;
  });
}

TEST(StalledReaders, TakeBoundedMemoryAndDoNotDelayTheStop) {
  Findings findings("stalled readers");
  const int readers = Size(40, 250);
  ConnectedServer server({.flags = {"--drain-seconds=0.1"}});
  server.Start();
  const client::Client client = server.NewClient();
  const std::string job = OrThrow(client.Create(ClosedForms(kPoints))).name();
  OrThrow(client.Watch(job, {}, {.give_up_after = absl::FromChrono(kPatience)}));
  const double before = server.ResidentMiB();
  Process stalled({.command = {std::filesystem::read_symlink("/proc/self/exe"), kReadersFlag,
                               std::to_string(readers), server.address(), job}});
  ASSERT_TRUE(stalled.WaitUntilStopped()) << stalled.Wait().err;
  AwaitQuiet(server);
  const double growth = server.ResidentMiB() - before;
  findings.Count("readers", readers);
  findings.Count("MiB in the server", static_cast<int64_t>(growth));
  EXPECT_LT(growth, kMostMiB);
  EXPECT_EQ(server.Stop(), 0);
}

}  // namespace
}  // namespace ballpiston::torture

int main(int argc, char** argv) {
  using namespace ballpiston;
  if (argc == 5 && std::string(argv[1]) == torture::kReadersFlag) {
    torture::RunStalledReaders(std::atoi(argv[2]), argv[3], argv[4]);
  }
  return RunTests(argc, argv);
}
