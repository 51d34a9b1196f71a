#include "server/rpc/client_version.h"

#include <string>

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/version.h"
#include "tests/server/error_details.h"
#include "tests/server/running_server.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr auto kNotServed = absl::StatusCode::kFailedPrecondition;

TEST(ClientVersion, TheSameMajorVersionIsServed) {
  EXPECT_OK(CheckClientVersion("ballpiston/1.0.0 grpc-c++/1.51.1", "1.0.0"));
  EXPECT_OK(CheckClientVersion("ballpiston/1.9.3 (python) grpc-python/1.51.1", "1.2.0"));
  EXPECT_OK(CheckClientVersion("ballpiston/0.1.7", "0.1.0"));
}

TEST(ClientVersion, AnotherMajorVersionIsRefused) {
  EXPECT_THAT(CheckClientVersion("ballpiston/2.0.0 grpc-c++/1.51.1", "1.0.0"),
              StatusIs(kNotServed, AllOf(HasSubstr("Install version 1 of the client"),
                                         HasSubstr("version 2 of the server"))));
  EXPECT_THAT(CheckClientVersion("ballpiston/0.9.0", "1.0.0"), StatusIs(kNotServed));
}

TEST(ClientVersion, BeforeOneAnotherMinorVersionIsRefused) {
  EXPECT_THAT(CheckClientVersion("ballpiston/0.2.0", "0.1.0"),
              StatusIs(kNotServed, HasSubstr("clients of version 0.1")));
  EXPECT_THAT(CheckClientVersion("ballpiston/1.0.0", "0.1.0"), StatusIs(kNotServed));
}

TEST(ClientVersion, OtherProgramsAreServed) {
  for (const char* user_agent :
       {"", "grpc-python/1.51.1", "curl/8.0", "ballpiston/", "ballpiston/next", "ballpiston/1.2",
        "ballpiston/-1.2.3", "ballpiston/99999999999999999999.0.0"}) {
    EXPECT_OK(CheckClientVersion(user_agent, "1.0.0")) << user_agent;
  }
}

// gRPC passes the user agent on to the server, and the answer comes back with its reason.
TEST(ClientVersion, AServerChecksEveryCall) {
  RunningServer server;
  struct Case {
    std::string version;
    grpc::StatusCode code;
    const char* reason;
  };
  for (const auto& [version, code, reason] :
       {Case{kVersion, grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"},
        Case{"77.0.0", grpc::StatusCode::FAILED_PRECONDITION, "CLIENT_VERSION_NOT_SERVED"}}) {
    grpc::ChannelArguments arguments;
    arguments.SetUserAgentPrefix("ballpiston/" + version);
    const auto channel =
        grpc::CreateCustomChannel(server.address(), grpc::InsecureChannelCredentials(), arguments);
    grpc::ClientContext context;
    v1::GetEnsembleJobRequest request;
    request.set_name("ensembleJobs/none");
    v1::EnsembleJob job;
    const grpc::Status status =
        v1::EnsembleService::NewStub(channel)->GetEnsembleJob(&context, request, &job);
    EXPECT_THAT(status, IsError(code, reason));
  }
}

}  // namespace
}  // namespace ballpiston::server
