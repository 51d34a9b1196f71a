// A server behind TLS stops in time, whatever its clients do, and old connections are exchanged.
#include <openssl/bio.h>
#include <openssl/ssl.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>

#include "client/library/ensemble_client.h"
#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/http_get.h"
#include "tests/support/running_server.h"
#include "tests/server/secure_server.h"
#include "tests/server/unread_call.h"

namespace ballpiston::server {
namespace {

constexpr char kWatch[] = "/ballpiston.v1.EnsembleService/WatchEnsembleJob";

// A client that has made TLS and says nothing.
class SilentTlsConnection {
 public:
  explicit SilentTlsConnection(const std::string& address)
      : context_(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free),
        connection_(BIO_new_ssl_connect(context_.get()), &BIO_free_all) {
    BIO_set_conn_hostname(connection_.get(), address.c_str());
    SSL* ssl = nullptr;
    BIO_get_ssl(connection_.get(), &ssl);
    const unsigned char alpn[] = "\x02h2";
    SSL_set_alpn_protos(ssl, alpn, 3);
    EXPECT_EQ(BIO_do_connect(connection_.get()), 1);
  }

 private:
  const std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context_;
  const std::unique_ptr<BIO, void (*)(BIO*)> connection_;
};

class TlsClients : public testing::Test {
 protected:
  explicit TlsClients(bool mutual = false, const ConnectionTiming& timing = {}) : files_(mutual) {
    if (mutual) files_.WriteAccessFile("certificate alice alice submit\n");
    ServerOptions options = SecureOptions(files_.options(), folder_.path());
    options.connections = timing;
    options.factory =
        FakeExperiments([this](size_t, uint64_t, std::stop_token stop) { gate_.Pass(stop); });
    auto server = BallpistonServer::Start(options);
    EXPECT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    const auto own = mutual ? files_.authority().Issue("alice") : KeyAndCertificate();
    channel_ = SecureChannel(server_->address(), files_.authority().Pem(), own);
  }

  std::string Submit(int points) {
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = Equilibrium(points, 1);
    request.set_request_id("123e4567-e89b-12d3-a456-426614174000");
    v1::EnsembleJob job;
    const auto stub = v1::EnsembleService::NewStub(channel_);
    grpc::Status status;
    do {  // on a busy machine a connection may grow too old meanwhile
      grpc::ClientContext context;
      context.set_wait_for_ready(true);  // so that only such a call is repeated
      context.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(2));
      if (files_.options().tls_client_ca.empty()) {
        context.AddMetadata("authorization", std::string("Bearer ") + kAlice);
      }
      status = stub->CreateEnsembleJob(&context, request, &job);
    } while (status.error_code() == grpc::StatusCode::UNAVAILABLE);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return job.name();
  }

  const LaboratoryFiles files_;
  TemporaryFolder folder_;
  Gate gate_;
  std::unique_ptr<BallpistonServer> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(TlsClients, ThatHangDoNotKeepTheServerFromStopping) {
  v1::WatchEnsembleJobRequest request;
  request.set_name(Submit(1000));
  const Connection no_handshake(server_->address());
  Connection half_a_handshake(server_->address());
  half_a_handshake.Send("\x16\x03\x01");
  const SilentTlsConnection silent(server_->address());
  UnreadCall watch(channel_, kWatch, kAlice);
  watch.Send(request.SerializeAsString());
  UnreadCall health(channel_, "/grpc.health.v1.Health/Watch", kAlice);
  health.Send(std::string("\x0a\0", 2));
  auto stopped =
      std::async(std::launch::async, [this] { server_->Shutdown(std::chrono::milliseconds(300)); });
  // The limit tells a stop from none; a busy machine may take long to start a thread.
  ASSERT_EQ(stopped.wait_for(std::chrono::seconds(60)), std::future_status::ready);
}

class OldConnections : public TlsClients {
 protected:
  explicit OldConnections(std::chrono::milliseconds grace = std::chrono::milliseconds(1000))
      : TlsClients(
            true, {.certified_age = std::chrono::milliseconds(200), .certified_age_grace = grace}) {
  }
};

// No call lasts as long.
class OldConnectionsWithTime : public OldConnections {
 protected:
  OldConnectionsWithTime() : OldConnections(std::chrono::minutes(10)) {}
};

// The connection is exchanged again and again while the job is held; whoever watches sees
// its end.
TEST_F(OldConnections, AreExchangedUnderAWatchThatGoesOn) {
  const std::string name = Submit(3);
  int cuts = 0;
  client::WatchCallbacks callbacks;
  callbacks.on_disconnect = [&](const absl::Status&, absl::Duration) {
    if (++cuts == 3) gate_.Open();
  };
  client::WatchOptions options;
  options.max_backoff = absl::Milliseconds(50);
  const auto ended = client::EnsembleClient(channel_).Watch(name, callbacks, options);
  ASSERT_TRUE(ended.ok()) << ended.status();
  EXPECT_EQ(ended->state(), v1::EnsembleJob::SUCCEEDED);
  EXPECT_GE(cuts, 3);
}

// Calls are made one after the other for longer than a connection lives.
TEST_F(OldConnectionsWithTime, AreExchangedBetweenCallsOfWhichNoneFails) {
  const std::string name = Submit(1);
  const auto enough = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (std::chrono::steady_clock::now() < enough) {
    const auto job = client::EnsembleClient(channel_).Get(name);
    ASSERT_TRUE(job.ok()) << job.status();
  }
  gate_.Open();
}

}  // namespace
}  // namespace ballpiston::server
