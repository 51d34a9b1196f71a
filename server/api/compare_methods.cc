#include "server/api/compare_methods.h"

#include <utility>

#include "server/convert/errors.h"
#include "server/convert/method.h"

namespace ballpiston::server {
namespace {

// What the comparison ended with, as the API says it.
absl::Status EndOf(const absl::Status& status, bool draining) {
  if (status.ok()) return status;
  if (draining) return ShuttingDown();
  if (absl::IsCancelled(status)) return status;  // the client is gone
  return WithReason(absl::InternalError(status.message()), "INTERNAL");
}

}  // namespace

CompareMethodsReactor* CompareMethodsReactor::Start(ServiceContext& service,
                                                    const absl::StatusOr<Call>& call,
                                                    const v1::CompareMethodsRequest& request) {
  std::shared_ptr<CompareMethodsReactor> reactor(new CompareMethodsReactor(service, call));
  reactor->self_ = reactor;
  absl::Status refused = call.status();
  if (call.ok()) refused = service.watches.Add(reactor.get(), call->caller.name, service.limits);
  if (refused.ok()) refused = reactor->Begin(request);
  if (!refused.ok()) reactor->End(refused);
  return reactor.get();
}

CompareMethodsReactor::CompareMethodsReactor(ServiceContext& service,
                                             const absl::StatusOr<Call>& call)
    : service_(service),
      principal_(call.ok() ? call->caller.name : ""),
      active_(service.activity.Begin()) {}

absl::Status CompareMethodsReactor::Begin(const v1::CompareMethodsRequest& request) {
  const CheckedComparison checked = CheckComparison(request);
  if (!checked.violations.empty()) return InvalidRequest(checked.violations);
  const ComparisonThread::Admission admission = service_.comparisons.Begin(
      {.principal = principal_,
       .spec = checked.spec,
       .stop = stop_,
       .tell = [self = self_](const auto& made) { self->Tell(MeasurementMessage(made)); },
       .ended =
           [self = self_](const absl::Status& status) {
             self->End(EndOf(status, self->service_.draining));
           }});
  if (admission == ComparisonThread::Admission::kBusy) return ComparisonRunning();
  if (admission == ComparisonThread::Admission::kStopped) return ShuttingDown();
  return absl::OkStatus();
}

// ---- reactions: on gRPC's threads, and on that of the registry ----

void CompareMethodsReactor::Look(std::chrono::steady_clock::time_point) {
  if (!service_.draining) return;
  {
    std::lock_guard lock(mutex_);
    if (end_) return;
  }
  service_.executor.PostOfStream(principal_,
                                 [self = shared_from_this()] { self->Cut(ShuttingDown()); });
}

void CompareMethodsReactor::OnWriteDone(bool ok) {
  {
    std::lock_guard lock(mutex_);
    writing_ = false;
  }
  if (ok) return Advance();
  OnCancel();
}

void CompareMethodsReactor::OnCancel() { Cut(absl::CancelledError("the client is gone")); }

void CompareMethodsReactor::OnDone() {
  service_.watches.Remove(this);
  self_.reset();  // may delete this
}

// ---- what to say ----

void CompareMethodsReactor::Tell(v1::MethodMeasurement message) {
  {
    std::lock_guard lock(mutex_);
    if (end_) return;
    waiting_.push_back(std::move(message));
  }
  Advance();
}

void CompareMethodsReactor::End(const absl::Status& status) {
  {
    std::lock_guard lock(mutex_);
    if (!end_) end_ = status;
  }
  Advance();
}

void CompareMethodsReactor::Cut(const absl::Status& status) {
  stop_.request_stop();
  {
    std::lock_guard lock(mutex_);
    waiting_.clear();
  }
  End(status);
}

void CompareMethodsReactor::Advance() {
  std::unique_lock lock(mutex_);
  if (writing_ || finished_) return;
  if (!waiting_.empty()) {
    message_ = std::move(waiting_.front());
    waiting_.pop_front();
    writing_ = true;
    lock.unlock();
    StartWrite(&message_);
  } else if (end_) {
    finished_ = true;
    const absl::Status end = *end_;
    lock.unlock();
    Finish(GrpcStatus(end));
  }
}

}  // namespace ballpiston::server
