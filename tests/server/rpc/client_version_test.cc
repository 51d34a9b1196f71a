#include "server/rpc/client_version.h"

#include "server/version.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// The same major version is served; before version 1, the same minor version. Other programs are
// served.
TEST(ClientVersion, DecidesWhetherAClientIsServed) {
  const struct {
    const char* user_agent;
    const char* server;
    const char* refusal;  // a part of it; empty: served
  } rows[] = {{"ballpiston/1.0.0 grpc-c++/1.51.1", "1.0.0", ""},
              {"ballpiston/1.9.3 (python) grpc-python/1.51.1", "1.2.0", ""},
              {"ballpiston/0.1.7", "0.1.0", ""},
              {"ballpiston/2.0.0 grpc-c++/1.51.1", "1.0.0", "Install version 1 of the client"},
              {"ballpiston/2.0.0 grpc-c++/1.51.1", "1.0.0", "version 2 of the server"},
              {"ballpiston/0.9.0", "1.0.0", "version 1"},
              {"ballpiston/0.2.0", "0.1.0", "clients of version 0.1"},
              {"ballpiston/1.0.0", "0.1.0", "clients of version 0.1"},
              {"", "1.0.0", ""},
              {"grpc-python/1.51.1", "1.0.0", ""},
              {"ballpiston/", "1.0.0", ""},
              {"ballpiston/next", "1.0.0", ""},
              {"ballpiston/1.2", "1.0.0", ""},
              {"ballpiston/-1.2.3", "1.0.0", ""},
              {"ballpiston/99999999999999999999.0.0", "1.0.0", ""}};
  for (const auto& [user_agent, server, refusal] : rows) {
    const absl::Status checked = CheckClientVersion(user_agent, server);
    const auto code = *refusal ? absl::StatusCode::kFailedPrecondition : absl::StatusCode::kOk;
    EXPECT_THAT(checked, StatusIs(code, HasSubstr(refusal))) << user_agent;
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
