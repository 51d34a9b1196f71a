// Serves http://HOST:PORT/metrics for Prometheus, on the loopback only, because the page is neither
// encrypted nor authenticated.
//
// prometheus-cpp's Exposer is the HTTP server. It answers GET of /metrics and nothing else, ends a
// request that is not complete after kRequestTimeout, and serves at most kHttpThreads requests at a
// time; a further one waits.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "prometheus/collectable.h"
#include "prometheus/exposer.h"
#include "prometheus/metric_family.h"

namespace ballpiston::server {

inline constexpr int kHttpThreads = 4;
inline constexpr std::chrono::milliseconds kRequestTimeout(1000);

class MetricsEndpoint {
 public:
  using Source = std::function<std::vector<prometheus::MetricFamily>()>;

  // `address` is HOST:PORT on the loopback, with a numeric HOST; port 0: any free port. A thread of
  // the HTTP server calls `source` for each request, one thread at a time. UNAVAILABLE if the
  // server cannot listen at the address.
  // The destructor takes up to 2 s, because the HTTP server checks only every 2 s whether it should
  // stop.
  static absl::StatusOr<std::unique_ptr<MetricsEndpoint>> Start(const std::string& address,
                                                                Source source);

  const std::string& address() const { return address_; }  // with the port in use

  // Waits for a call of the source to return. The source is not called again; later requests get
  // the page without its metrics.
  void Detach() { exposer_.RemoveCollectable(collector_); }

 private:
  MetricsEndpoint(const std::string& address, Source source);

  const std::shared_ptr<prometheus::Collectable> collector_;  // calls the source
  prometheus::Exposer exposer_;
  const std::string address_;
};

}  // namespace ballpiston::server
