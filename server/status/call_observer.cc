#include "server/status/call_observer.h"

#include <chrono>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "server/status/log.h"

namespace ballpiston::server {
namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::ServerRpcInfo;
using prometheus::Labels;

constexpr char kReflection[] = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";
constexpr int kLinesPerSecond = 10;

// Upper bounds, in seconds; prometheus-cpp adds an unbounded bucket.
const std::vector<double> kBuckets = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30};

// In gRPC's order: a streaming client adds 1, a streaming server 2.
constexpr const char* kTypes[] = {"unary", "client_stream", "server_stream", "bidi_stream"};

// `path` is /PACKAGE.SERVICE/METHOD.
Labels LabelsOf(const std::string& path, size_t type) {
  const std::pair<std::string, std::string> names =
      absl::StrSplit(absl::StripPrefix(path, "/"), absl::MaxSplits('/', 1));
  return {
      {"grpc_service", names.first}, {"grpc_method", names.second}, {"grpc_type", kTypes[type]}};
}

prometheus::Family<prometheus::Counter>& Counter(const char* name, const char* help,
                                                 prometheus::Registry& registry) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

}  // namespace

Verdict VerdictOn(const FailedCall& call) {
  switch (call.code) {
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kPermissionDenied:
      return Verdict::kNotLetIn;
    case absl::StatusCode::kResourceExhausted:
      return Verdict::kLimitReached;
    case absl::StatusCode::kUnavailable:
      return call.reason == "SHUTTING_DOWN" ? Verdict::kOrdinary : Verdict::kServerFailed;
    case absl::StatusCode::kUnknown:
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kDataLoss:
      return Verdict::kServerFailed;
    default:
      return Verdict::kOrdinary;
  }
}

// The known reasons start at zero, because Prometheus does not see the first increase of a counter
// that appears with 1.
CallObserver::CallObserver()
    : began_(Counter("grpc_server_started_total", "Calls that began.", registry_)),
      ended_(Counter("grpc_server_handled_total", "Calls that ended, by code.", registry_)),
      seconds_(prometheus::BuildHistogram()
                   .Name("grpc_server_handling_seconds")
                   .Help("From a call's begin to its end.")
                   .Register(registry_)),
      not_let_in_(Counter("ballpiston_failed_authentications_total",
                          "Calls without valid credentials or with too low a role.", registry_)),
      limits_reached_(Counter("ballpiston_limit_refusals_total",
                              "Calls rejected because a limit was reached.", registry_)) {
  for (const char* reason :
       {"CREDENTIALS_MISSING", "CREDENTIALS_INVALID", "CREDENTIALS_EXPIRED", "ROLE_TOO_LOW"}) {
    not_let_in_.Add({{"reason", reason}});
  }
  for (const char* reason :
       {"TOO_MANY_JOBS", "TOO_MANY_ACTIVE_POINTS", "TOO_MANY_POINTS", "TOO_MANY_STORED_BYTES",
        "TOO_MANY_PINNED_BYTES", "TOO_MANY_STREAMS", "TOO_MANY_CALLS"}) {
    limits_reached_.Add({{"reason", reason}});
  }
}

// ---- counts ----

// Observes one call. gRPC runs its hooks one after the other.
class CallObserver::Interceptor : public grpc::experimental::Interceptor {
 public:
  Interceptor(CallObserver& observer, ServerRpcInfo& info)
      : observer_(observer),
        call_(*info.server_context()),
        method_(LabelsOf(info.method(), static_cast<size_t>(info.type()))),
        is_of_api_(absl::StartsWith(info.method(), "/ballpiston.")) {
    observer_.began_.Add(method_).Increment();
    if (is_of_api_) observer_.activity_.Begin();
  }

  ~Interceptor() override {
    Ended(absl::StatusCode::kCancelled);  // if no status was sent
    if (is_of_api_) observer_.activity_.End();
    decltype(observer_.kept_)::node_type kept;  // is released after the mutex
    MutexLock lock(observer_.mutex_);
    kept = observer_.kept_.extract(&call_);
  }

  // If the client has left, the status that gRPC's own services return looks like a fault.
  void Intercept(grpc::experimental::InterceptorBatchMethods* batch) override {
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
      Ended(call_.IsCancelled()
                ? absl::StatusCode::kCancelled
                : static_cast<absl::StatusCode>(batch->GetSendStatus().error_code()));
    }
    batch->Proceed();
  }

 private:
  void Ended(absl::StatusCode code) {
    if (std::exchange(ended_, true)) return;
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin_;
    Labels with_code = method_;
    with_code["grpc_code"] = absl::StatusCodeToString(code);
    observer_.ended_.Add(with_code).Increment();
    observer_.seconds_.Add(method_, kBuckets).Observe(time.count());
  }

  CallObserver& observer_;
  const grpc::ServerContextBase& call_;
  const Labels method_;
  const bool is_of_api_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  bool ended_ = false;
};

class CallObserver::Factory : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit Factory(CallObserver& observer) : observer_(observer) {}
  // gRPC takes a method that no service has for a stream of both sides.
  grpc::experimental::Interceptor* CreateServerInterceptor(ServerRpcInfo* info) override {
    const bool is_known = info->type() != ServerRpcInfo::Type::BIDI_STREAMING ||
                          absl::string_view(info->method()) == kReflection;
    return is_known ? new Interceptor(observer_, *info) : nullptr;
  }

 private:
  CallObserver& observer_;
};

std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>
CallObserver::InterceptorFactory() {
  return std::make_unique<Factory>(*this);
}

void CallObserver::Keep(const grpc::ServerContextBase& call, std::shared_ptr<void> object) {
  MutexLock lock(mutex_);
  kept_[&call] = std::move(object);
}

// ---- failed calls ----

void CallObserver::Failed(const FailedCall& call, absl::Time now) {
  const Verdict verdict = VerdictOn(call);
  if (verdict == Verdict::kOrdinary) return;
  const bool failed = verdict == Verdict::kServerFailed;
  const bool not_let_in = verdict == Verdict::kNotLetIn;
  if (!failed) {
    (not_let_in ? not_let_in_ : limits_reached_).Add({{"reason", call.reason}}).Increment();
  }
  if (!TakeLine(failed, now)) return;
  const char* what = failed ? "call failed: " : not_let_in ? "access denied: " : "call rejected: ";
  Log(failed ? Severity::kError : Severity::kWarning, absl::StrCat(what, call.message),
      {{"method", call.method},
       {"principal", call.principal},
       {"code", absl::StatusCodeToString(call.code)},
       {"reason", call.reason},
       {"seconds", call.seconds}});
}

bool CallObserver::TakeLine(bool failed, absl::Time now) {
  MutexLock lock(mutex_);
  Lines& lines = failed ? failed_ : refused_;
  const int64_t second = absl::ToUnixSeconds(now);
  if (std::exchange(lines.second, second) != second) lines.written = 0;
  return ++lines.written <= kLinesPerSecond;
}

}  // namespace ballpiston::server
