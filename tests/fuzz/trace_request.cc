// TraceOrbit: the start and the first events of every request that is accepted.
#include <cmath>

#include "ballpiston/v1/trace.pb.h"
#include "server/convert/trace.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

void RequireBody(double x, double y, double vx, double vy, double energy) {
  Require(std::isfinite(x) && std::isfinite(y), "a position");
  Require(std::isfinite(vx) && std::isfinite(vy), "a velocity");
  Require(std::isfinite(energy) && energy >= 0, "an energy");
}

void RequireStart(const v1::TraceStart& start) {
  Require(start.eta() >= 0 && start.tip() > 0, "a geometry");
  Require(start.balls_size() >= 1 && start.pistons_size() >= 1, "bodies");
  for (const auto& body : start.balls()) {
    RequireBody(body.x(), body.y(), body.vx(), body.vy(), body.energy());
  }
  for (const auto& body : start.pistons()) {
    RequireBody(body.x(), body.y(), body.vx(), body.vy(), body.energy());
  }
}

void RequireEvent(const v1::TraceEvent& event) {
  Require(event.has_ball() || event.has_piston(), "a body takes part");
  if (event.has_ball()) {
    RequireBody(event.ball_x(), event.ball_y(), event.ball_vx(), event.ball_vy(),
                event.ball_energy());
  }
  if (event.has_piston()) {
    RequireBody(event.piston_x(), event.piston_y(), event.piston_vx(), event.piston_vy(),
                event.piston_energy());
  }
}

void CheckTraceRequest(const std::string& bytes) {
  v1::TraceOrbitRequest request;
  if (!request.ParseFromString(bytes)) return;
  auto messages = server::TraceMessages::Create(request);
  if (!messages.ok()) return RequireSendable(messages.status(), bytes);
  v1::TraceOrbitResponse message;
  messages->FillNext(message);
  RequireStart(message.start());
  Require(!messages->HasEnded(), "events follow");
  message.Clear();
  messages->FillNext(message);
  double time = 0;
  for (const v1::TraceEvent& event : message.events()) {
    Require(event.event() != v1::TraceEvent::escape, "no ball escapes");
    Require(event.time() >= time && std::isfinite(event.time()), "time goes on");
    time = event.time();
    RequireEvent(event);
  }
}

const Registration kTraceRequest({.name = "trace_request",
                                  .check = CheckTraceRequest,
                                  .message = &v1::TraceOrbitRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
