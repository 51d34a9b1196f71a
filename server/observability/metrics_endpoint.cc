#include "server/observability/metrics_endpoint.h"

#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

absl::StatusOr<ListenAddress> ParseLoopback(const std::string& text) {
  absl::StatusOr<ListenAddress> address = ParseListenAddress(text);
  if (!address.ok() || !address->socket_path.empty() || !address->IsLoopback()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--metrics-listen=", text,
        " is not a loopback address; permitted: HOST:PORT with a HOST in 127.0.0.0/8, [::1] or "
        "localhost (metrics are not encrypted; let others reach them through a proxy or a "
        "tunnel)"));
  }
  return address;
}

std::vector<std::string> HttpOptions(const ListenAddress& address) {
  return {"listening_ports",    address.Text(),
          "num_threads",        absl::StrCat(kHttpThreads),
          "request_timeout_ms", absl::StrCat(kRequestTimeout.count()),
          "enable_keep_alive",  "no"};
}

class Collector : public prometheus::Collectable {
 public:
  explicit Collector(MetricsEndpoint::Source source) : source_(std::move(source)) {}

  // The HTTP server that calls this is written in C, so no exception may leave this function.
  std::vector<prometheus::MetricFamily> Collect() const override try {
    return source_();
  } catch (const std::exception&) {
    return {};
  }

 private:
  const MetricsEndpoint::Source source_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(const std::string& address,
                                                                        Source source) {
  const absl::StatusOr<ListenAddress> parsed = ParseLoopback(address);
  if (!parsed.ok()) return parsed.status();
  try {
    return std::unique_ptr<MetricsEndpoint>(new MetricsEndpoint(*parsed, std::move(source)));
  } catch (const std::exception&) {  // the page is served without these metrics
    return absl::FailedPreconditionError(
        absl::StrCat("--metrics-listen=", address,
                     ": cannot listen there (in use, or not permitted); choose another address"));
  }
}

MetricsEndpoint::MetricsEndpoint(ListenAddress address, Source source)
    : address_(std::move(address)),
      collector_(std::make_shared<Collector>(std::move(source))),
      exposer_(HttpOptions(address_)) {
  address_.port = exposer_.GetListeningPorts().front();
  exposer_.RegisterCollectable(collector_);
}

}  // namespace ballpiston::server
