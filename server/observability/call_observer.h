// Observes the beginning and the end of every call of every service. Counts the call, remembers its
// caller while it runs, and logs each call that failed in the server or was rejected.
//
// It is an interceptor of gRPC, so it also sees calls that never reach a method of the project:
// malformed messages, health, reflection. A call counts as ended just before its status is sent, so
// a client that has the answer finds the call counted. Methods that no service has are not counted,
// because clients could invent any number of them. The counters are prometheus-cpp's; no library
// connects them to gRPC's C++ server. Thread-safe.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "grpcpp/server_context.h"
#include "grpcpp/support/server_interceptor.h"
#include "prometheus/collectable.h"
#include "prometheus/counter.h"
#include "prometheus/family.h"
#include "prometheus/registry.h"
#include "server/mutex.h"
#include "server/observability/call_statistics.h"
#include "server/observability/line_budget.h"

namespace ballpiston::server {

// The metadata key of a call's request id, in the request and in the answer.
inline constexpr char kRequestId[] = "x-request-id";

// A call that ended with an error.
struct FailedCall {
  std::string method;      // WatchEnsembleJob
  std::string principal;   // empty: not authenticated
  std::string request_id;  // empty: the call did not reach the project's own frame
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

  // Sets the caller, for the log. Call before the method runs.
  void Identify(const grpc::ServerContextBase& call, const std::string& principal);

  // Keeps an object until gRPC has sent the answer, which it does after the method has returned.
  void Keep(const grpc::ServerContextBase& call, std::shared_ptr<void> object);

  CallStatistics& statistics() { return statistics_; }

  // The counts of all calls, of those that failed authentication or authorisation, and of those
  // that were refused because a limit was reached.
  const prometheus::Collectable& metrics() const { return registry_; }

  // Counts and logs a failed call. For the interceptors, and for tests.
  void Failed(const FailedCall& call);

 private:
  class Interceptor;
  class Factory;

  struct CallInProgress {
    std::string principal;
    std::shared_ptr<void> kept = nullptr;
  };

  std::string CallerOf(const grpc::ServerContextBase& call);
  void Forget(const grpc::ServerContextBase& call);
  void WriteLine(const FailedCall& call, Verdict verdict);

  prometheus::Registry registry_;  // first: it owns the counters of the next three
  CallStatistics statistics_;
  prometheus::Family<prometheus::Counter>& not_let_in_;      // by reason
  prometheus::Family<prometheus::Counter>& limits_reached_;  // by reason
  LineBudget refusals_{10, std::chrono::seconds(1)};
  LineBudget failures_{10, std::chrono::seconds(1)};

  Mutex mutex_;
  std::map<const grpc::ServerContextBase*, CallInProgress> in_progress_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
