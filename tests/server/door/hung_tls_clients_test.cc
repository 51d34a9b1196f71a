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
  explicit TlsClients(bool mutual = false, const ConnectionTiming& timing = kOnlyClosedByAStop)
      : files_(mutual),
        own_(mutual ? files_.authority().Issue("alice") : KeyAndCertificate()),
        server_(Start(timing)) {}

  RunningServer Start(const ConnectionTiming& timing) {
    const bool mutual = !own_.certificate.empty();
    if (mutual) files_.WriteAccessFile("certificate alice alice submit\n");
    return RunningServer(
        Secure(files_, {.factory = GatedExperiments(gate_),
                        .connections = timing,
                        .credentials = files_.Credentials(mutual ? "" : kAlice, own_)}));
  }

  std::string Submit(int points) {
    const auto request = CreateRequest(Equilibrium(points, 1), kUuid);
    v1::EnsembleJob job;
    grpc::Status status;
    AwaitThat([&] {  // on a busy machine the connection may become too old during the call
      grpc::ClientContext context;
      context.set_wait_for_ready(true);  // only a call on such a connection fails then
      status = server_.ensemble().CreateEnsembleJob(&context, request, &job);
      return status.error_code() != grpc::StatusCode::UNAVAILABLE;
    });
    EXPECT_OK(status);
    return job.name();
  }

  const LaboratoryFiles files_;
  const KeyAndCertificate own_;
  Gate gate_;
  RunningServer server_;
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

class OldConnections : public TlsClients {
 protected:
  explicit OldConnections(std::chrono::milliseconds grace = std::chrono::milliseconds(1000))
      : TlsClients(
            true, {.certified_age = std::chrono::milliseconds(200), .certified_age_grace = grace}) {
  }
};

// The grace time is longer than any call.
class OldConnectionsWithTime : public OldConnections {
 protected:
  OldConnectionsWithTime() : OldConnections(kNever) {}
};

// The connection is replaced again and again while the job is held; the watch sees its end.
TEST_F(OldConnections, AreReplacedDuringAWatchThatGoesOn) {
  const std::string name = Submit(3);
  int cuts = 0;
  client::WatchCallbacks callbacks;
  callbacks.on_disconnect = [&](const absl::Status&, absl::Duration) {
    if (++cuts == 3) gate_.Open();
  };
  client::WatchOptions options;
  options.max_backoff = absl::Milliseconds(50);
  options.give_up_after = absl::FromChrono(kPatience);
  ASSERT_OK_AND_ASSIGN(const auto ended,
                       client::Client(server_.channel()).Watch(name, callbacks, options));
  EXPECT_EQ(ended.state(), v1::EnsembleJob::SUCCEEDED);
  EXPECT_GE(cuts, 3);
}

// How often a channel has lost its connection.
class LostConnections {
 public:
  explicit LostConnections(std::shared_ptr<grpc::Channel> channel)
      : watcher_([this, channel](const std::stop_token& stop) {
          grpc_connectivity_state state = channel->GetState(false);
          while (!stop.stop_requested()) {
            const auto soon = std::chrono::system_clock::now() + std::chrono::milliseconds(50);
            if (!channel->WaitForStateChange(state, soon)) continue;
            const grpc_connectivity_state next = channel->GetState(false);
            count_ += state == GRPC_CHANNEL_READY && next != GRPC_CHANNEL_READY;
            state = next;
          }
        }) {}

  int count() const { return count_; }

 private:
  std::atomic<int> count_ = 0;
  std::jthread watcher_;
};

TEST_F(OldConnectionsWithTime, AreReplacedBetweenCallsAndAllCallsSucceed) {
  const std::string name = Submit(1);
  const LostConnections lost(server_.channel());
  const client::Client client(server_.channel(), absl::FromChrono(kPatience));
  AwaitThat([&] {
    EXPECT_OK(client.Get(name));
    return lost.count() >= 3 || HasFailure();
  });
  gate_.Open();
}

}  // namespace
}  // namespace ballpiston::server
