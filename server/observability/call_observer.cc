#include "server/observability/call_observer.h"

#include <atomic>
#include <chrono>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/observability/log.h"

namespace ballpiston::server {
namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::InterceptorBatchMethods;
using grpc::experimental::ServerRpcInfo;
using Clock = std::chrono::steady_clock;

std::string ReasonIn(const std::string& error_details) {
  google::rpc::Status status;
  google::rpc::ErrorInfo info;
  if (!status.ParseFromString(error_details)) return "";
  for (const google::protobuf::Any& detail : status.details()) {
    if (detail.UnpackTo(&info)) return info.reason();
  }
  return "";
}

std::string MethodIn(absl::string_view path) {
  return std::string(path.substr(path.rfind('/') + 1));
}

}  // namespace

Verdict VerdictOn(const FailedCall& call) {
  switch (call.code) {
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kPermissionDenied:
      return Verdict::kNotLetIn;
    case absl::StatusCode::kResourceExhausted:  // a limit, or a full disk
      return absl::StartsWith(call.reason, "STORE_") ? Verdict::kServerFailed
                                                     : Verdict::kLimitReached;
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
    : statistics_(registry_),
      not_let_in_(prometheus::BuildCounter()
                      .Name("ballpiston_failed_authentications_total")
                      .Help("Calls without valid credentials or with too low a role.")
                      .Register(registry_)),
      limits_reached_(prometheus::BuildCounter()
                          .Name("ballpiston_limit_refusals_total")
                          .Help("Calls rejected because a limit was reached.")
                          .Register(registry_)) {
  for (const char* reason :
       {"CREDENTIALS_MISSING", "CREDENTIALS_INVALID", "CREDENTIALS_EXPIRED", "ROLE_TOO_LOW"}) {
    not_let_in_.Add({{"reason", reason}});
  }
  for (const char* reason :
       {"QUEUE_FULL", "TOO_MANY_JOBS", "TOO_MANY_ACTIVE_POINTS", "TOO_MANY_POINTS",
        "TOO_MANY_SAMPLES", "TOO_MANY_STORED_BYTES", "TOO_MANY_STREAMS", "TOO_MANY_CALLS"}) {
    limits_reached_.Add({{"reason", reason}});
  }
}

// Observes one call. gRPC runs its hooks one after the other.
class CallObserver::Interceptor : public grpc::experimental::Interceptor {
 public:
  Interceptor(CallObserver& observer, ServerRpcInfo& info)
      : observer_(observer),
        call_(*info.server_context()),
        path_(info.method()),
        labels_(CallStatistics::Of(path_, info.type())),
        begin_(Clock::now()) {
    observer_.statistics_.Began(labels_);
  }

  ~Interceptor() override {
    if (!ended_) observer_.statistics_.Ended(labels_, absl::StatusCode::kCancelled, Seconds());
    observer_.Forget(call_);
  }

  void Intercept(InterceptorBatchMethods* batch) override {
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS))
      StatusOf(*batch);
    batch->Proceed();
  }

 private:
  double Seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  // gRPC's own services return UNKNOWN if the client left, and INTERNAL if the request was missing
  // or malformed. Both would look like errors of the server.
  absl::StatusCode CodeOf(const grpc::Status& status) const {
    const auto code = static_cast<absl::StatusCode>(status.error_code());
    if (!absl::StartsWith(path_, "/grpc.")) return code;
    const bool unparsed = status.error_message() == "could not parse request";
    if (code != absl::StatusCode::kUnknown && !unparsed) return code;
    if (call_.IsCancelled()) return absl::StatusCode::kCancelled;
    return unparsed ? absl::StatusCode::kInvalidArgument : code;
  }

  void StatusOf(InterceptorBatchMethods& batch) {
    if (ended_.exchange(true)) return;
    const grpc::Status status = batch.GetSendStatus();
    const absl::StatusCode code = CodeOf(status);
    const double seconds = Seconds();
    observer_.statistics_.Ended(labels_, code, seconds);
    const std::string principal = observer_.CallerOf(call_);
    if (status.ok()) return;
    const auto* trailing = batch.GetSendTrailingMetadata();
    const auto id = trailing->find(kRequestId);
    observer_.Failed({.method = MethodIn(path_),
                      .principal = principal,
                      .request_id = id == trailing->end() ? "" : id->second,
                      .code = code,
                      .reason = ReasonIn(status.error_details()),
                      .message = status.error_message(),
                      .seconds = seconds});
  }

  CallObserver& observer_;
  const grpc::ServerContextBase& call_;
  const std::string path_;
  const prometheus::Labels labels_;
  const Clock::time_point begin_;
  std::atomic<bool> ended_ = false;
};

class CallObserver::Factory : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit Factory(CallObserver& observer) : observer_(observer) {}
  grpc::experimental::Interceptor* CreateServerInterceptor(ServerRpcInfo* info) override {
    return new Interceptor(observer_, *info);
  }

 private:
  CallObserver& observer_;
};

std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>
CallObserver::InterceptorFactory() {
  return std::make_unique<Factory>(*this);
}

// ---- callers ----

void CallObserver::Identify(const grpc::ServerContextBase& call, const std::string& principal) {
  MutexLock lock(mutex_);
  in_progress_[&call].principal = principal;
}

void CallObserver::Keep(const grpc::ServerContextBase& call, std::shared_ptr<void> object) {
  MutexLock lock(mutex_);
  in_progress_[&call].kept = std::move(object);
}

std::string CallObserver::CallerOf(const grpc::ServerContextBase& call) {
  MutexLock lock(mutex_);
  const auto found = in_progress_.find(&call);
  return found == in_progress_.end() ? "" : found->second.principal;
}

void CallObserver::Forget(const grpc::ServerContextBase& call) {
  std::shared_ptr<void> kept;  // released without the lock
  MutexLock lock(mutex_);
  const auto found = in_progress_.find(&call);
  if (found == in_progress_.end()) return;
  kept = std::move(found->second.kept);
  in_progress_.erase(found);
}

// ---- failed calls ----

void CallObserver::Failed(const FailedCall& call) {
  const Verdict verdict = VerdictOn(call);
  if (verdict == Verdict::kOrdinary) return;
  const std::string reason =
      call.reason.empty() ? absl::StatusCodeToString(call.code) : call.reason;
  if (verdict != Verdict::kServerFailed) {
    (verdict == Verdict::kNotLetIn ? not_let_in_ : limits_reached_)
        .Add({{"reason", reason}})
        .Increment();
  }
  WriteLine(call, verdict);
}

void CallObserver::WriteLine(const FailedCall& call, Verdict verdict) {
  const bool failed = verdict == Verdict::kServerFailed;
  const std::optional<int64_t> left_out = (failed ? failures_ : refusals_).Take(Clock::now());
  if (!left_out) return;
  const char* what = failed                          ? "call failed: "
                     : verdict == Verdict::kNotLetIn ? "access denied: "
                                                     : "call rejected: ";
  Log(failed ? Severity::kError : Severity::kWarning, absl::StrCat(what, call.message),
      {{"method", call.method},
       {"principal", call.principal},
       {"request_id", call.request_id},
       {"code", absl::StatusCodeToString(call.code)},
       {"reason", call.reason},
       {"seconds", call.seconds},
       {"lines_left_out", *left_out == 0 ? "" : absl::StrCat(*left_out)}});
}

}  // namespace ballpiston::server
