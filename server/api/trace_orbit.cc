#include "server/api/trace_orbit.h"

#include <memory>

namespace ballpiston::server {

TraceReactor* TraceReactor::Start(ServiceContext& service, grpc::CallbackServerContext& context,
                                  const absl::StatusOr<Call>& call,
                                  const v1::TraceOrbitRequest& request) {
  const std::shared_ptr<TraceReactor> reactor(new TraceReactor(service, context, request));
  reactor->StreamReactor::Start(call);
  return reactor.get();
}

void TraceReactor::Look(Clock::time_point now) {
  {
    MutexLock lock(mutex_);
    if (ended_ || now < next_check_) return;
  }
  Schedule();
}

absl::Status TraceReactor::Tell() {
  if (!messages_) {
    const absl::Status begun = Begin();
    if (!begun.ok()) return begun;
  }
  messages_->FillNext(message_);
  messages_->HasEnded() ? WriteLastAndEnd() : Write();
  return absl::OkStatus();
}

absl::Status TraceReactor::Begin() {
  const absl::StatusOr<TraceQuestion> question = TraceQuestion::Create(request_);
  if (!question.ok()) return question.status();
  HeldCalls& calls = service_.executor.held_calls();
  const absl::Status held = calls.Begin(caller_.name, question->Bytes(), service_.limits);
  if (!held.ok()) return held;
  bytes_held_ = question->Bytes();
  messages_ = question->Start();
  return absl::OkStatus();
}

void TraceReactor::ReleaseCall() {
  if (bytes_held_ > 0) service_.executor.held_calls().End(caller_.name, bytes_held_);
}

}  // namespace ballpiston::server
