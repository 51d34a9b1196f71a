// Counts the calls of every service, and counts and logs those that were refused or failed.
//
// The counts grpc_server_* are made by an interceptor of gRPC, so they include calls that never
// reach a method of the project: malformed messages, health, reflection. A call counts as ended
// just before its status is sent, so a client that has the answer finds the call counted. Methods
// that no service has are not counted, because clients could invent any number of them.
// Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "grpcpp/server_context.h"
#include "grpcpp/support/server_interceptor.h"
#include "prometheus/collectable.h"
#include "prometheus/counter.h"
#include "prometheus/family.h"
#include "prometheus/histogram.h"
#include "prometheus/registry.h"
#include "server/mutex.h"
#include "server/status/activity.h"

namespace ballpiston::server {

// A call of a method of the project that ended with an error.
struct FailedCall {
  std::string method;     // WatchEnsembleJob
  std::string principal;  // empty: not authenticated
  absl::StatusCode code = absl::StatusCode::kUnknown;
  std::string reason;  // of its ErrorInfo, if there is one
  std::string message;
  double seconds = 0;
};

// How the call is logged and counted.
enum class Verdict {
  kOrdinary,      // not logged: an invalid request, a missing job, a client that left
  kNotLetIn,      // missing or wrong credentials, or a role too low
  kLimitReached,  // a limit of the server or of the caller is reached
  kServerFailed   // an error of the server or of its disk
};
Verdict VerdictOn(const FailedCall& call);

class CallObserver {
 public:
  CallObserver();

  // For ServerBuilder::experimental().SetInterceptorCreators. This must outlive the server.
  std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface> InterceptorFactory();

  // Keeps an object until gRPC has sent the answer, which it does after the method has returned.
  void Keep(const grpc::ServerContextBase& call, std::shared_ptr<void> object);

  // Counts the call by its reason, and logs it. At most ten lines a second are written about calls
  // that were refused, and ten about calls that failed, so that a client with a thousand refused
  // calls a second does not fill the disk; the metrics count all of them.
  void Failed(const FailedCall& call, absl::Time now = absl::Now());

  const prometheus::Collectable& metrics() const { return registry_; }

  // Counts the calls of the API, but not those of health and reflection. A call is in progress
  // until gRPC has sent its answer.
  Activity& activity() { return activity_; }

 private:
  class Interceptor;
  class Factory;

  // The lines about calls in one second.
  struct Lines {
    int64_t second = 0;
    int written = 0;
  };

  // Whether one more line is to be written now.
  bool TakeLine(bool failed, absl::Time now);

  prometheus::Registry registry_;  // first: it owns the counters
  prometheus::Family<prometheus::Counter>& began_;
  prometheus::Family<prometheus::Counter>& ended_;
  prometheus::Family<prometheus::Histogram>& seconds_;
  prometheus::Family<prometheus::Counter>& not_let_in_;      // by reason
  prometheus::Family<prometheus::Counter>& limits_reached_;  // by reason

  Activity activity_;
  Mutex mutex_;
  Lines refused_ ABSL_GUARDED_BY(mutex_);
  Lines failed_ ABSL_GUARDED_BY(mutex_);
  std::map<const grpc::ServerContextBase*, std::shared_ptr<void>> kept_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
