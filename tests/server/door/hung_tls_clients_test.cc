// A server with TLS stops in time although its clients hang, and it replaces old connections.
#include <atomic>
#include <chrono>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>

#include "client/library/client.h"
#include "gtest/gtest.h"
#include "tests/server/call_by_name.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/http_get.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/server/secure_server.h"
#include "tests/server/unread_call.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

// A server whose jobs wait at a gate.
class TlsClients : public testing::Test {
 protected:
  std::string Submit(int points) {
    v1::EnsembleJob job;
    EXPECT_OK(server_.Create(CreateRequest(Equilibrium(points, 1), kUuid), &job));
    return job.name();
  }

  const LaboratoryFiles files_;
  Gate gate_;
  RunningServer server_{Secure(files_, {.factory = GatedExperiments(gate_),
                                        .connections = kOnlyClosedByAStop,
                                        .credentials = files_.Credentials(kAlice)})};
};

// A stop that waited for more than the end of the time to drain would never end.
TEST_F(TlsClients, HungClientsDoNotDelayAStop) {
  v1::WatchEnsembleJobRequest request;
  request.set_name(Submit(1000));
  const Connection no_handshake(server_.address());
  Connection half_a_handshake(server_.address());
  half_a_handshake.Send("\x16\x03\x01");
  const SilentTlsConnection silent(server_.address());
  EXPECT_EQ(silent.served_common_name(), "server-1");
  UnreadCall watch(server_.channel(), kWatchJob);
  watch.Send(request.SerializeAsString());
  UnreadCall health(server_.channel(), kWatchHealth);
  health.Send(kWholeServer);
  server_.Shutdown(std::chrono::milliseconds(300));
  EXPECT_THAT(CallByName(server_.channel(), kCheckHealth), StatusIs(grpc::StatusCode::UNAVAILABLE));
}

}  // namespace
}  // namespace ballpiston::server
