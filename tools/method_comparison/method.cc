#include "tools/method_comparison/method.h"

#include <cstddef>
#include <type_traits>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/billiard/orbits.h"
#include "server/processor_time.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"
#include "tools/method_comparison/trajectory_horizon.h"

namespace ballpiston::method_comparison {
namespace {

template <typename Flow>
Flow FlowFrom(const PairGeometry& geometry, const PairStateOf<RealOf<Flow>>& start,
              double time_step) {
  if constexpr (std::is_same_v<Flow, FixedStepFlow>) return Flow(geometry, start, time_step);
  return Flow(geometry, start);
}

// One orbit of a flow in any precision, or with fixed time steps.
template <typename Flow>
class FlowOrbit {
 public:
  explicit FlowOrbit(const Flow& flow) : flow_(flow) {}

  // Makes one event, and adds it to `collision`. True if the orbit reached a collision or is lost.
  bool Advance(Collision& collision) {
    const auto event = flow_.Step();
    collision.Add({event.kind, static_cast<double>(event.duration)});
    standing_ = event.duration > 0 ? 0 : standing_ + 1;
    collision.escaped = collision.escaped || standing_ > kStandsStill;
    return collision.escaped || event.kind == EventKind::kBallPiston;
  }
  PairState state() const { return RoundedTo<double>(flow_.state()); }
  void ExchangeComponents() { flow_.ExchangeComponents(); }

 private:
  static constexpr int kStandsStill = 1000;  // successive events at the same time

  Flow flow_;
  int standing_ = 0;
};

// ---- from collision to collision ----

template <typename Flow>
void RunOrbit(FlowOrbit<Flow> orbit, uint64_t index, NumberedOrbits& source) {
  for (Collision collision;;) {
    if (!orbit.Advance(collision)) continue;
    collision.state = orbit.state();
    if (source.Collide(index, collision) == AfterCollision::kEnd) return;
    orbit.ExchangeComponents();
    collision = {};
  }
}

template <typename Flow>
void RunEach(const PairGeometry& geometry, uint64_t orbits, NumberedOrbits& source,
             double time_step) {
  for (uint64_t i = 0; i < orbits; ++i) {
    const auto start = RoundedTo<RealOf<Flow>>(source.Start(i));
    RunOrbit(FlowOrbit(FlowFrom<Flow>(geometry, start, time_step)), i, source);
  }
}

template <Engine engine>
void RunByEngine(const PairGeometry& geometry, uint64_t orbits, NumberedOrbits& source,
                 double /*time_step*/) {
  source.Run(engine, geometry, orbits);
}

// ---- from wall hit to wall hit ----

template <typename To>
std::vector<PairStateOf<To>> Starts(const TwinOrbits& twins) {
  std::vector<PairStateOf<To>> starts;
  for (size_t i = 0; i < twins.Count(); ++i) starts.push_back(RoundedTo<To>(twins.Start(i)));
  return starts;
}

template <typename Flow>
void FlyOrbit(FlowOrbit<Flow> orbit, uint64_t hits, std::vector<BallAt>& places) {
  for (Collision way; places.size() < hits;) {
    orbit.Advance(way);
    if (way.escaped) return;
    if (way.ball_wall_hits == places.size()) continue;
    places.push_back({way.time, orbit.state().position});
  }
}

// Flies the orbits one after the other.
template <typename Flow>
Itineraries FlyEach(const PairGeometry& geometry, const TwinOrbits& twins, uint64_t hits,
                    double time_step) {
  const auto starts = Starts<RealOf<Flow>>(twins);
  Itineraries result;
  result.orbits.resize(starts.size());
  for (std::vector<BallAt>& places : result.orbits) places.reserve(hits);
  result.seconds = server::SecondsOf([&] {
    for (size_t i = 0; i < starts.size(); ++i) {
      result.orbits[i].clear();
      FlyOrbit(FlowOrbit(FlowFrom<Flow>(geometry, starts[i], time_step)), hits, result.orbits[i]);
    }
  });
  return result;
}

// The measured time does not include the records of the positions: the lanes are so fast that the
// records would dominate.
template <FlyLanes& fly>
Itineraries FlyInLanes(const PairGeometry& geometry, const TwinOrbits& twins, uint64_t hits,
                       double /*time_step*/) {
  const std::vector<LaneFrame> frames = OnTheirWalls(Starts<double>(twins));
  std::vector<LaneHit> recorded(frames.size() * hits);
  fly(geometry, frames, hits, recorded);
  Itineraries result;
  for (size_t i = 0; i < frames.size(); ++i) {
    std::vector<BallAt>& places = result.orbits.emplace_back();
    double time = 0;
    for (size_t k = 0; k < hits; ++k) {
      const LaneHit& hit = recorded[i * hits + k];
      places.push_back({time += hit.length, PositionInCell(hit.frame)});
    }
  }
  result.seconds = server::SecondsOf([&] { fly(geometry, frames, hits, {}); });
  return result;
}

// ---- the methods ----

template <typename Flow>
constexpr Method ByFlow(const char* name, double seconds_per_event) {
  return {name, seconds_per_event, RunEach<Flow>, FlyEach<Flow>};
}

// All lanes are to be full except at the end, but the orbits have to fit into the memory.
template <Engine engine, FlyLanes& fly>
constexpr Method ByLanes(const char* name) {
  return {name, 4e-9, RunByEngine<engine>, FlyInLanes<fly>, 1 << 17};
}

}  // namespace

Method FixedSteps(double time_step) {
  Method method = ByFlow<FixedStepFlow>("fixed-step", 3e-9);
  method.time_step = time_step;
  return method;
}

constinit const Method kReferenceSingle =
    ByFlow<EventFlow<float>>("billiard-reference-single", 4e-8);
constinit const Method kReference = {.name = "billiard-reference",
                                     .seconds_per_event = 4e-8,
                                     .run_orbits = RunByEngine<Engine::kReference>,
                                     .fly = FlyEach<ReferenceFlow>,
                                     .model = Model::kBilliardReference};
constinit const Method kReferenceLongDouble =
    ByFlow<EventFlow<long double>>("billiard-reference-long-double", 1e-7);
constinit const Method kReferenceQuadruple =
    ByFlow<EventFlow<Quad>>("billiard-reference-quadruple", 3e-6);
constinit const Method kLanes = ByLanes<Engine::kLanes, FlyLaneBalls>("billiard");
constinit const Method kLanesSingle =
    ByLanes<Engine::kLanesSingle, FlyLaneBallsSingle>("billiard-single");
constinit const Method kClosedForm = {.name = "closed-form"};
constinit const Method kMarkov = {.name = "markov", .model = Model::kMarkov};
constinit const Method kSpectrum = {.name = "spectrum"};

}  // namespace ballpiston::method_comparison
