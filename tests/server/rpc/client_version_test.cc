#include "server/rpc/client_version.h"

#include "server/version.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// The same major version is served; before version 1, the same minor version. Other programs are
// served.
TEST(ClientVersion, DecidesWhetherAClientIsServed) {
  for (const char* served :
       {"ballpiston/1.0.0 grpc-c++/1.51.1", "ballpiston/1.9.3 (python) grpc-python/1.51.1", "",
        "grpc-python/1.51.1", "ballpiston/next", "ballpiston/2.2", "ballpiston/-2.2.3",
        "ballpiston/99999999999999999999.0.0"}) {
    EXPECT_OK(CheckClientVersion(served, "1.2.0")) << served;
  }
  EXPECT_OK(CheckClientVersion("ballpiston/0.1.7", "0.1.0"));
  for (const auto& [refused, server, advice] :
       {std::tuple("ballpiston/2.0.0 grpc-c++/1.51.1", "1.0.0",
                   "Install version 1 of the client, or version 2 of the server"),
        {"ballpiston/0.9.0", "1.0.0", "version 1 of the client, or version 0.9"},
        {"ballpiston/0.2.0", "0.1.0", "clients of version 0.1;"},
        {"ballpiston/1.0.0", "0.1.0", "clients of version 0.1;"}}) {
    EXPECT_THAT(CheckClientVersion(refused, server),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(advice)));
  }
}

// gRPC passes the user agent on to the server, and the answer comes back with its reason.
TEST(ClientVersion, AServerChecksEveryCall) {
  RunningServer server;
  for (const auto& [version, reason] :
       {std::pair(kVersion, "JOB_NOT_FOUND"), {"77.0.0", "CLIENT_VERSION_NOT_SERVED"}}) {
    grpc::ChannelArguments arguments;
    arguments.SetUserAgentPrefix(absl::StrCat("ballpiston/", version));
    const TestClient client(OwnChannel(server.address(), nullptr, arguments));
    EXPECT_EQ(ReasonOf(client.Delete("ensembleJobs/none")), reason);
  }
}

}  // namespace
}  // namespace ballpiston::server
