#include "server/api/trace_orbit.h"

#include "server/convert/trace.h"

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
  if (trace_ == nullptr) return TellStart();
  AddEvents();
  events_left_ == 0 ? WriteLastAndEnd() : Write();
  return absl::OkStatus();
}

absl::Status TraceReactor::TellStart() {
  const absl::StatusOr<TraceQuestion> question = TraceQuestion::Create(request_);
  if (!question.ok()) return question.status();
  HeldCalls& calls = service_.executor.held_calls();
  const absl::Status held = calls.Begin(caller_.name, question->Bytes(), service_.limits);
  if (!held.ok()) return held;
  bytes_held_ = question->Bytes();
  trace_ = question->StartTrace();
  events_left_ = question->events();
  *message_.mutable_start() = question->StartMessage(*trace_);
  Write();
  return absl::OkStatus();
}

void TraceReactor::AddEvents() {
  for (int i = 0; i < kEventsOfMessage && events_left_ > 0; ++i) {
    const std::optional<TraceEvent> event = trace_->Next();
    if (event) *message_.add_events() = TraceEventMessage(*event);
    events_left_ = event ? events_left_ - 1 : 0;
  }
}

void TraceReactor::ReleaseCall() {
  if (bytes_held_ > 0) service_.executor.held_calls().End(caller_.name, bytes_held_);
}

}  // namespace ballpiston::server
