// Counts the calls of each method: how many began, how many ended with which code, and how long
// they took, in the families grpc_server_* of a registry. Thread-safe.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "grpcpp/support/server_interceptor.h"
#include "prometheus/counter.h"
#include "prometheus/family.h"
#include "prometheus/histogram.h"
#include "prometheus/labels.h"
#include "prometheus/registry.h"

namespace ballpiston::server {

class CallStatistics {
 public:
  using MethodType = grpc::experimental::ServerRpcInfo::Type;

  // The registry must outlive this object.
  explicit CallStatistics(prometheus::Registry& registry);

  // The labels of a method. `path` is /PACKAGE.SERVICE/METHOD.
  static prometheus::Labels Of(const std::string& path, MethodType type);

  void Began(const prometheus::Labels& method);
  void Ended(const prometheus::Labels& method, absl::StatusCode code, double seconds);

  // Adds the methods of a service of the generated protos, with zeros, before their first call.
  void Expect(const std::string& service);

 private:
  prometheus::Histogram& SecondsOf(const prometheus::Labels& method);
  prometheus::Counter& EndedWith(absl::StatusCode code, prometheus::Labels method);

  prometheus::Family<prometheus::Counter>& began_;
  prometheus::Family<prometheus::Counter>& ended_;
  prometheus::Family<prometheus::Histogram>& seconds_;
};

}  // namespace ballpiston::server
