// Where Prometheus comes to collect: http://HOST:PORT/metrics, on the loopback.
//
// The numbers are asked for when somebody collects, and by whoever does: on the threads of the HTTP
// server, which are its own. It answers GET of /metrics and nothing else, gives up on a request
// that is not complete after kRequestTimeout, and holds at most kHttpThreads of them; a further one
// waits. It is neither encrypted nor asks who is there: so no other machine reaches it.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_METRICS_ENDPOINT_H_
#define BALLPISTON_SERVER_OBSERVABILITY_METRICS_ENDPOINT_H_

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "prometheus/exposer.h"
#include "prometheus/metric_family.h"

namespace ballpiston::server {

inline constexpr int kHttpThreads = 4;
inline constexpr std::chrono::milliseconds kRequestTimeout(1000);

class MetricsEndpoint {
 public:
  using Source = std::function<std::vector<prometheus::MetricFamily>()>;

  // HOST:PORT, with a HOST in 127.0.0.0/8, [::1] or localhost; port 0: any that is free. `source`
  // is called by one thread at a time.
  //   INVALID_ARGUMENT     the address is none of these
  //   FAILED_PRECONDITION  nobody can listen there
  static absl::StatusOr<std::unique_ptr<MetricsEndpoint>> Start(const std::string& address,
                                                                Source source);
  // Takes as long as a request that is not complete is waited for, if there is one.
  ~MetricsEndpoint();

  const std::string& address() const { return address_; }  // with the port that was chosen

  // The source is asked no more when this returns; who collects then gets an empty page.
  void Detach();

 private:
  class Collector;

  MetricsEndpoint(std::string host, std::unique_ptr<prometheus::Exposer> exposer,
                  std::shared_ptr<Collector> collector);

  const std::string host_;  // without brackets
  std::unique_ptr<prometheus::Exposer> exposer_;
  const std::shared_ptr<Collector> collector_;
  const int port_;
  const std::string address_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_METRICS_ENDPOINT_H_
