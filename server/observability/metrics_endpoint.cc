#include "server/observability/metrics_endpoint.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "prometheus/collectable.h"
#include "server/listen_address.h"

namespace ballpiston::server {
namespace {

constexpr std::chrono::milliseconds kKnockInterval(5);

absl::StatusOr<ListenAddress> ParseLoopback(const std::string& text) {
  absl::StatusOr<ListenAddress> address = ParseListenAddress(text);
  if (!address.ok() || !address->socket_path.empty() || !address->IsLoopback()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--metrics-listen=", text,
        " is not a loopback address; permitted: HOST:PORT with a HOST in 127.0.0.0/8, [::1] or "
        "localhost (metrics are not encrypted; let others reach them through a proxy or a "
        "tunnel)"));
  }
  if (address->host == "localhost") address->host = "127.0.0.1";  // the HTTP server takes no names
  return address;
}

std::string TextOf(const std::string& host, int port) {
  ListenAddress address;
  address.host = host;
  address.port = port;
  return address.Text();
}

// Connects and leaves again: an HTTP server that looks up every two seconds only does so now.
void Knock(const std::string& host, int port) {
  addrinfo hints = {};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), absl::StrCat(port).c_str(), &hints, &found) != 0) return;
  const int descriptor = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor >= 0) {
    [[maybe_unused]] const int connected = connect(descriptor, found->ai_addr, found->ai_addrlen);
    close(descriptor);
  }
  freeaddrinfo(found);
}

std::vector<std::string> HttpOptions(const ListenAddress& address) {
  return {"listening_ports",    address.Text(),
          "num_threads",        absl::StrCat(kHttpThreads),
          "request_timeout_ms", absl::StrCat(kRequestTimeout.count()),
          "enable_keep_alive",  "no"};
}

}  // namespace

class MetricsEndpoint::Collector : public prometheus::Collectable {
 public:
  explicit Collector(Source source) : source_(std::move(source)) {}

  void Detach() {
    std::lock_guard lock(mutex_);
    source_ = nullptr;
  }

  // Its caller is written in C: nothing may be thrown.
  std::vector<prometheus::MetricFamily> Collect() const override {
    std::lock_guard lock(mutex_);
    try {
      if (source_) return source_();
    } catch (const std::exception&) {
    }
    return {};
  }

 private:
  mutable std::mutex mutex_;
  Source source_;
};

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(const std::string& address,
                                                                        Source source) {
  const absl::StatusOr<ListenAddress> parsed = ParseLoopback(address);
  if (!parsed.ok()) return parsed.status();
  try {
    auto exposer = std::make_unique<prometheus::Exposer>(HttpOptions(*parsed));
    auto collector = std::make_shared<Collector>(std::move(source));
    exposer->RegisterCollectable(collector);
    return std::unique_ptr<MetricsEndpoint>(
        new MetricsEndpoint(parsed->host, std::move(exposer), std::move(collector)));
  } catch (const std::exception&) {  // its words help nobody
    return absl::FailedPreconditionError(
        absl::StrCat("--metrics-listen=", address,
                     ": cannot listen there (in use, or not permitted); choose another address"));
  }
}

MetricsEndpoint::MetricsEndpoint(std::string host, std::unique_ptr<prometheus::Exposer> exposer,
                                 std::shared_ptr<Collector> collector)
    : host_(std::move(host)),
      exposer_(std::move(exposer)),
      collector_(std::move(collector)),
      port_(exposer_->GetListeningPorts().front()),
      address_(TextOf(host_, port_)) {}

MetricsEndpoint::~MetricsEndpoint() {
  Detach();
  std::atomic<bool> stopped = false;
  std::thread knocking([&] {
    while (!stopped) {
      Knock(host_, port_);
      std::this_thread::sleep_for(kKnockInterval);
    }
  });
  exposer_.reset();
  stopped = true;
  knocking.join();
}

void MetricsEndpoint::Detach() { collector_->Detach(); }

}  // namespace ballpiston::server
