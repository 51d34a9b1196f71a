// SIGTERM ends the server in time, whatever its clients do.
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/library/client.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/hung_readers.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::torture {
namespace {

// The server only waits in this time, so the short form has less.
double DrainSeconds() { return HoldsToTimes() ? 1 : 0.1; }
constexpr char kPreface[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";  // of every HTTP/2 connection

// A connection that sends these bytes and nothing more.
class HalfOpenConnection {
 public:
  HalfOpenConnection(const std::string& address, const std::string& bytes)
      : socket_(socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    const std::string path = address.substr(std::strlen("unix:"));
    path.copy(name.sun_path, sizeof(name.sun_path) - 1);
    if (connect(socket_, reinterpret_cast<sockaddr*>(&name), sizeof(name)) != 0 ||
        send(socket_, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("no connection to " + address);
    }
  }
  ~HalfOpenConnection() { close(socket_); }
  HalfOpenConnection(const HalfOpenConnection&) = delete;
  HalfOpenConnection& operator=(const HalfOpenConnection&) = delete;

 private:
  const int socket_;
};

// A call whose headers are sent and whose request never comes.
class CallWithoutMessage {
 public:
  CallWithoutMessage(const std::shared_ptr<grpc::Channel>& channel, const std::string& method)
      : stub_(channel), call_(stub_.PrepareCall(&context_, method, &queue_)) {
    call_->StartCall(this);
    void* tag = nullptr;
    bool ok = false;
    if (!queue_.Next(&tag, &ok) || !ok) throw std::runtime_error("no call of " + method);
  }
  ~CallWithoutMessage() {
    context_.TryCancel();
    grpc::Status status;
    call_->Finish(&status, this);
    void* tag = nullptr;
    bool ok = false;
    queue_.Next(&tag, &ok);
    queue_.Shutdown();
    while (queue_.Next(&tag, &ok)) {
    }
  }
  CallWithoutMessage(const CallWithoutMessage&) = delete;
  CallWithoutMessage& operator=(const CallWithoutMessage&) = delete;

 private:
  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  grpc::GenericStub stub_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
};

class HungClients : public testing::Test {
 protected:
  HungClients()
      : server_({.workers = 2, .flags = {absl::StrFormat("--drain-seconds=%g", DrainSeconds())}}) {
    server_.Start();
    name_ = OrThrow(server_.NewClient().Create(ManyPoints(20'000, 1'000))).name();
  }

  // Seconds from SIGTERM to the process's end.
  double Stop() {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(server_.Stop(), 0);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  void CheckStop(const std::string& clients) {
    const double seconds = Stop();
    findings_.Note("seconds to stop, " + clients, absl::StrFormat("%.2f", seconds));
    if (HoldsToTimes()) {
      EXPECT_LT(seconds, DrainSeconds() + 1) << clients;
    }
  }

  Findings findings_{absl::StrFormat("SIGTERM, %g s to drain", DrainSeconds())};
  ConnectedServer server_;
  std::string name_;
};

TEST_F(HungClients, TheServerStopsInTimeWithoutThem) { CheckStop("no clients"); }

TEST_F(HungClients, UnreadWatchesDoNotDelayTheStop) {
  const HungReaders readers(20, server_.address(), name_);
  CheckStop("stalled watches");
}

TEST_F(HungClients, HalfOpenConnectionsDoNotDelayTheStop) {
  const HalfOpenConnection silent(server_.address(), "");
  const HalfOpenConnection begun(server_.address(), kPreface);
  const HalfOpenConnection other(server_.address(), "GET / HTT");
  CheckStop("half-open connections");
}

TEST_F(HungClients, CallsWithoutAMessageDoNotDelayTheStop) {
  const auto channel = server_.Connect();
  const std::string service = "/ballpiston.v1.EnsembleService/";
  const CallWithoutMessage create(channel, service + "CreateEnsembleJob");
  const CallWithoutMessage watch(channel, service + "WatchEnsembleJob");
  const CallWithoutMessage health(channel, "/grpc.health.v1.Health/Check");
  // This call uses the same connection. When it is answered, the earlier calls have arrived.
  ASSERT_OK(client::Client(channel, absl::FromChrono(kPatience)).Get(name_));
  CheckStop("calls without a message");
}

}  // namespace
}  // namespace ballpiston::torture
