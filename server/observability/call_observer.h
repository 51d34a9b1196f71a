// Sees every call of every service begin and end: counts it, remembers who makes it while it runs,
// and writes a line for each that the server failed at or refused.
//
// It sits inside gRPC (an interceptor), so it also sees calls that never reach their method: a
// message that is malformed, health, reflection. A call counts as ended just before its status is
// sent: whoever has the answer finds it counted. A method that no service offers is not counted:
// anybody could invent any number of them. The counters are prometheus-cpp's; no library connects
// them to gRPC's C++ server. Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_CALL_OBSERVER_H_
#define BALLPISTON_SERVER_OBSERVABILITY_CALL_OBSERVER_H_

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

// The metadata that a call's id comes with, and goes back in.
inline constexpr char kRequestId[] = "x-request-id";

// A call that ended with anything but OK.
struct FailedCall {
  std::string method;      // WatchEnsembleJob
  std::string principal;   // empty: it was not let in
  std::string request_id;  // empty: it was not looked at by the project's own frame
  absl::StatusCode code = absl::StatusCode::kUnknown;
  std::string reason;  // of its ErrorInfo, if there is one
  std::string message;
  double seconds = 0;
};

// What an operator is told of.
enum class Verdict {
  kOrdinary,      // the request was wrong, the job is not there, the client left: nothing
  kNotLetIn,      // no credentials, wrong ones, or a role too low
  kLimitReached,  // a limit of the server's, or of the caller's, is reached
  kServerFailed   // an error of the server's own, or of its disk
};
Verdict VerdictOn(const FailedCall& call);

class CallObserver {
 public:
  CallObserver();

  // For ServerBuilder::experimental().SetInterceptorCreators. This has to outlive the server.
  std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface> InterceptorFactory();

  // Who makes the call, for the log. Before its method runs.
  void Identify(const grpc::ServerContextBase& call, const std::string& principal);

  CallStatistics& statistics() { return statistics_; }

  // The counts of all calls, of those that failed authentication or authorisation, and of those
  // that were refused because a limit was reached.
  const prometheus::Collectable& metrics() const { return registry_; }

  // Counts and logs. For the interceptors, and for tests.
  void Failed(const FailedCall& call);

 private:
  class Interceptor;
  class Factory;

  std::string Ended(const grpc::ServerContextBase& call);  // returns who made it
  void WriteLine(const FailedCall& call, Verdict verdict);

  prometheus::Registry registry_;  // first: it owns the counters of the next three
  CallStatistics statistics_;
  prometheus::Family<prometheus::Counter>& not_let_in_;      // by reason
  prometheus::Family<prometheus::Counter>& limits_reached_;  // by reason
  LineBudget refusals_{10, std::chrono::seconds(1)};
  LineBudget failures_{10, std::chrono::seconds(1)};

  Mutex mutex_;
  std::map<const grpc::ServerContextBase*, std::string> callers_
      ABSL_GUARDED_BY(mutex_);  // of calls in progress
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_CALL_OBSERVER_H_
