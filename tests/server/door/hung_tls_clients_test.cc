// A server with TLS stops in time although its clients hang.
#include <chrono>
#include <string>

#include "gtest/gtest.h"
#include "tests/server/call_by_name.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/http_get.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/server/secure_server.h"
#include "tests/server/unread_call.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

// A stop that waited for more than the end of the time to drain would never end.
TEST(TlsClients, HungClientsDoNotDelayAStop) {
  const LaboratoryFiles files;
  Gate gate;
  RunningServer server(Secure(files, {.factory = GatedExperiments(gate),
                                      .connections = kOnlyClosedByAStop,
                                      .credentials = files.Credentials(kAlice)}));
  v1::WatchEnsembleJobRequest request;
  request.set_name(server.Submit(Equilibrium(1000, 1)));
  const Connection no_handshake(server.address());
  Connection half_a_handshake(server.address());
  half_a_handshake.Send("\x16\x03\x01");
  const SilentTlsConnection silent(server.address());
  EXPECT_EQ(silent.served_common_name(), "server-1");
  UnreadCall watch(server.channel(), kWatchJob);
  watch.Send(request.SerializeAsString());
  UnreadCall health(server.channel(), kWatchHealth);
  health.Send(kWholeServer);
  server.Shutdown(std::chrono::milliseconds(300));
  EXPECT_THAT(CallByName(server.channel(), kCheckHealth), StatusIs(grpc::StatusCode::UNAVAILABLE));
}

}  // namespace
}  // namespace ballpiston::server
