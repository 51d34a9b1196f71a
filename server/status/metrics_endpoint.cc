#include "server/status/metrics_endpoint.h"

#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

std::vector<std::string> HttpOptions(const std::string& address) {
  return {"listening_ports",    address,
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
  } catch (const std::exception&) {  // the page is served without these metrics
    return {};
  }

 private:
  const MetricsEndpoint::Source source_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(const std::string& address,
                                                                        Source source) {
  try {
    return std::unique_ptr<MetricsEndpoint>(new MetricsEndpoint(address, std::move(source)));
  } catch (const std::exception&) {
    return absl::UnavailableError(
        absl::StrCat("--metrics-listen=", address,
                     ": cannot listen there (in use, or not permitted); choose another address"));
  }
}

MetricsEndpoint::MetricsEndpoint(const std::string& address, Source source)
    : collector_(std::make_shared<Collector>(std::move(source))),
      exposer_(HttpOptions(address)),
      address_(absl::StrCat(address.substr(0, address.rfind(':') + 1),
                            exposer_.GetListeningPorts().front())) {
  exposer_.RegisterCollectable(collector_);
}

}  // namespace ballpiston::server
