#include "server/convert/trace.h"

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/closed_form/pair_measures.h"
#include "core/ensemble/parameter.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/canonical_gas.h"
#include "core/sampling/counter_random.h"
#include "core/sampling/invariant_measure.h"
#include "server/convert/errors.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

using Violations = std::vector<FieldViolation>;

// Points of a grid have streams of their own.
constexpr uint64_t kTraceStream = 0x7472616365;

void Add(const char* field, const absl::Status& status, Violations& violations) {
  if (!status.ok()) violations.push_back({field, std::string(status.message())});
}

std::optional<GasShape> ShapeOf(const v1::TraceOrbitRequest& request, Violations& violations) {
  if (request.cells().empty()) return std::nullopt;
  const absl::StatusOr<GasShape> shape = ShapeOfText(request.cells());
  Add("cells", shape.status(), violations);
  if (!shape.ok()) return std::nullopt;
  if (shape->cells() > kMaxTracedCells) {
    violations.push_back(
        {"cells", absl::StrCat(Text(*shape), " has ", shape->cells(),
                               " cells; permitted in a trace: 1 to ", kMaxTracedCells)});
  }
  return *shape;
}

void CheckDelta(const v1::TraceOrbitRequest& request, bool has_rho, Violations& violations) {
  const double rho = request.rho(), delta = request.delta();
  if (!has_rho) return Add("delta", ValidatePositiveDelta(delta), violations);
  Add("delta",
      request.cells().empty() ? ValidatePairDelta(rho, delta) : ValidateGasDelta(rho, delta),
      violations);
}

// An orbit has the domain of a question by the billiard.
void CheckDomain(const v1::TraceOrbitRequest& request, Violations& violations) {
  const EnsembleSpec orbit = {.grid = {{kRho, {request.rho()}}, {kDelta, {request.delta()}}},
                              .model = Model::kBilliardReference};
  Violations found;
  CheckBilliardDomain(orbit, found);
  for (const FieldViolation& violation : found) {
    const bool is_of_rho = absl::StrContains(violation.field, "rho");
    violations.push_back({is_of_rho ? "rho" : "delta", violation.description});
  }
}

void CheckTemperature(const v1::TraceOrbitRequest& request, Violations& violations) {
  if (!request.has_temperature()) return;
  if (request.cells().empty()) {
    violations.push_back(
        {"temperature", "is set without cells; a pair has the energy 1/2, not a temperature"});
  } else {
    Add("temperature", kTemperature.Validate(request.temperature()), violations);
  }
}

void CheckEvents(int64_t events, Violations& violations) {
  if (events >= 1 && events <= kMaxTracedEvents) return;
  violations.push_back(
      {"events", absl::StrCat("is ", events, "; permitted: 1 to ", kMaxTracedEvents)});
}

template <typename Message>
void Fill(const TracedBody& body, Message& message) {
  message.set_x(body.position.x());
  message.set_y(body.position.y());
  message.set_vx(body.velocity.x());
  message.set_vy(body.velocity.y());
  message.set_energy(body.energy);
}

v1::TraceEvent::Kind KindMessage(EventKind kind) {
  switch (kind) {
    case EventKind::kBallWall:
      return v1::TraceEvent::ball_wall;
    case EventKind::kPistonWall:
      return v1::TraceEvent::piston_wall;
    case EventKind::kBallPiston:
      return v1::TraceEvent::ball_piston;
    case EventKind::kEscape:
      break;
  }
  return v1::TraceEvent::escape;
}

void FillBall(const TracedChange& change, v1::TraceEvent& message) {
  message.set_ball(static_cast<int32_t>(change.index));
  message.set_ball_x(change.after.position.x());
  message.set_ball_y(change.after.position.y());
  message.set_ball_vx(change.after.velocity.x());
  message.set_ball_vy(change.after.velocity.y());
  message.set_ball_energy_before(change.energy_before);
  message.set_ball_energy(change.after.energy);
}

void FillPiston(const TracedChange& change, v1::TraceEvent& message) {
  message.set_piston(static_cast<int32_t>(change.index));
  message.set_piston_x(change.after.position.x());
  message.set_piston_y(change.after.position.y());
  message.set_piston_vx(change.after.velocity.x());
  message.set_piston_vy(change.after.velocity.y());
  message.set_piston_energy_before(change.energy_before);
  message.set_piston_energy(change.after.energy);
}

void Fill(const TraceEvent& event, v1::TraceEvent& message) {
  message.set_time(event.time);
  message.set_event(KindMessage(event.kind));
  if (event.free_time) message.set_free_time(*event.free_time);
  if (event.ball) FillBall(*event.ball, message);
  if (event.piston) FillPiston(*event.piston, message);
}

v1::TraceStart StartMessage(const v1::TraceOrbitRequest& request, const PairGeometry& pair,
                            const Trace& trace) {
  v1::TraceStart start;
  start.set_event(v1::TraceEvent::start);
  start.set_rho(pair.rho());
  start.set_delta(pair.delta());
  start.set_lambda(pair.lambda());
  start.set_tip(pair.tip());
  start.set_eta(Measures(pair).eta);
  start.set_seed(request.seed());
  for (const TracedBody& ball : trace.Balls()) Fill(ball, *start.add_balls());
  for (const TracedBody& piston : trace.Pistons()) {
    Fill(piston, *start.add_pistons());
    start.mutable_pistons()->rbegin()->set_vertical(true);
  }
  return start;
}

}  // namespace

bool TraceMessages::FillNext(v1::TraceOrbitResponse& message) {
  if (start_) {
    *message.mutable_start() = *std::move(start_);
    start_.reset();
    return true;
  }
  if (events_left_ == 0) return false;
  for (int i = 0; i < kEventsOfMessage && events_left_ > 0; ++i) {
    const std::optional<TraceEvent> event = trace_->Next();
    if (event) Fill(*event, *message.add_events());
    events_left_ = event ? events_left_ - 1 : 0;
  }
  return true;
}

absl::StatusOr<TraceMessages> TraceMessages::Create(const v1::TraceOrbitRequest& request) {
  Violations violations;
  const absl::Status rho = ValidateRho(request.rho());
  Add("rho", rho, violations);
  CheckDelta(request, rho.ok(), violations);
  const std::optional<GasShape> shape = ShapeOf(request, violations);
  CheckTemperature(request, violations);
  CheckEvents(request.events(), violations);
  if (violations.empty()) CheckDomain(request, violations);
  if (!violations.empty()) return InvalidRequest(violations);
  if (!shape) {
    const absl::StatusOr<PairGeometry> pair = PairGeometry::Create(request.rho(), request.delta());
    return pair.ok() ? OfPair(request, *pair) : absl::StatusOr<TraceMessages>(pair.status());
  }
  const absl::StatusOr<GasGeometry> gas =
      GasGeometry::Create(request.rho(), request.delta(), *shape, GasEnds::kPeriodic);
  return gas.ok() ? OfGas(request, *gas) : absl::StatusOr<TraceMessages>(gas.status());
}

TraceMessages TraceMessages::OfPair(const v1::TraceOrbitRequest& request,
                                    const PairGeometry& pair) {
  CounterRandom random(request.seed(), kTraceStream, 0);
  auto trace = TracePair(pair, DrawFromFlowMeasure(pair, random));
  const v1::TraceStart start = StartMessage(request, pair, *trace);
  return TraceMessages(std::move(trace), start, request.events());
}

TraceMessages TraceMessages::OfGas(const v1::TraceOrbitRequest& request, const GasGeometry& gas) {
  CounterRandom random(request.seed(), kTraceStream, 0);
  const double temperature = request.has_temperature() ? request.temperature() : 1;
  auto trace = TraceGas(gas, DrawGas(gas, TemperatureProfile(temperature), random));
  v1::TraceStart start = StartMessage(request, gas.pair(), *trace);
  start.set_cells(Text(gas.shape()));
  start.set_temperature(temperature);
  for (int i = 0; i < start.pistons_size(); ++i) {
    start.mutable_pistons(i)->set_vertical(gas.IsAlongX(i));
  }
  return TraceMessages(std::move(trace), start, request.events());
}

}  // namespace ballpiston::server
