// Counts the calls of each method: how many began, how many ended with which code, and how long
// they took, in the families grpc_server_* of a registry.
//
// prometheus-cpp counts. The map from a method's path to its counters is ours: Family::Add, which
// also finds a counter, builds and hashes a map of labels each time, and the three of a call would
// take 1.3 us; with the map a call takes 0.2 us. Methods are those that the server has registered,
// so their number is bounded. Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_CALL_STATISTICS_H_
#define BALLPISTON_SERVER_OBSERVABILITY_CALL_STATISTICS_H_

#include <array>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "grpcpp/support/server_interceptor.h"
#include "prometheus/counter.h"
#include "prometheus/family.h"
#include "prometheus/histogram.h"
#include "prometheus/registry.h"
#include "server/mutex.h"

namespace ballpiston::server {

struct MethodCounts {
  prometheus::Counter* began;
  std::array<prometheus::Counter*, 17> ended;  // by code: 0 (OK) to 16 (UNAUTHENTICATED)
  prometheus::Histogram* seconds;

  void Ended(absl::StatusCode code, double duration) const;
};

class CallStatistics {
 public:
  using MethodType = grpc::experimental::ServerRpcInfo::Type;

  // The registry must outlive this object.
  explicit CallStatistics(prometheus::Registry& registry);

  // `path` is /PACKAGE.SERVICE/METHOD. The reference stays valid as long as this object. The first
  // call decides the type.
  const MethodCounts& Of(const std::string& path, MethodType type);

  // Adds the methods of a service of the generated protos, with zeros, before their first call.
  void Expect(const std::string& service);

 private:
  MethodCounts NewCounts(const std::string& path, MethodType type);

  prometheus::Family<prometheus::Counter>& began_;
  prometheus::Family<prometheus::Counter>& ended_;
  prometheus::Family<prometheus::Histogram>& seconds_;
  Mutex mutex_;
  std::map<std::string, MethodCounts> methods_ ABSL_GUARDED_BY(mutex_);  // by path
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_CALL_STATISTICS_H_
