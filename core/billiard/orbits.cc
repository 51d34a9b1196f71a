#include "core/billiard/orbits.h"

#include <limits>
#include <optional>
#include <utility>

#include "core/billiard/longest_wait.h"

namespace ballpiston {
namespace {

constexpr uint64_t kEventsBetweenLooks = 4096;  // about 0.2 ms, so a call of Pause costs nothing

// One orbit after the other.
class ReferenceOrbits : public EngineRun {
 public:
  ReferenceOrbits(const PairGeometry& geometry, OrbitSource& source)
      : geometry_(geometry),
        source_(source),
        limit_(source.TimeLimit()),
        follows_tangents_(source.FollowsTangents()),
        longest_wait_(geometry) {}

  bool Advance() override {
    for (uint64_t events = 1; flow_ || Begin(); ++events) {
      Step();
      if (events % kEventsBetweenLooks == 0 && source_.Pause()) return false;
    }
    return true;
  }

 private:
  bool Begin() {
    const std::optional<OrbitStart> start = source_.Next();
    if (!start) return false;
    orbit_ = start->orbit;
    flow_.emplace(geometry_, start->state);
    collision_ = {};
    longest_ = HasTimeLimit() ? limit_ : longest_wait_.From(start->state);
    return true;
  }
  bool HasTimeLimit() const { return limit_ < std::numeric_limits<double>::infinity(); }

  void Step() {
    const Event event = flow_->Step();
    collision_.Add(event);
    if (follows_tangents_) source_.FollowEvent(orbit_, event, flow_->state());
    const bool is_overdue = collision_.time > longest_;
    collision_.expired = is_overdue && HasTimeLimit();
    collision_.escaped |= is_overdue && !HasTimeLimit();
    const bool has_ended = collision_.escaped || collision_.expired;
    if (event.kind != EventKind::kBallPiston && !has_ended) return;
    collision_.state = flow_->state();
    const AfterCollision after = source_.Collide(orbit_, collision_);
    if (after == AfterCollision::kEnd || has_ended) return flow_.reset();
    flow_->ExchangeComponents();
    if (!HasTimeLimit()) longest_ = longest_wait_.From(flow_->state());
    collision_ = {};
  }

  PairGeometry geometry_;
  OrbitSource& source_;
  double limit_;
  bool follows_tangents_;
  LongestWait longest_wait_;
  double longest_ = 0;  // of the current wait
  uint64_t orbit_ = 0;
  std::optional<ReferenceFlow> flow_;
  Collision collision_;  // the next one, so far
};

std::unique_ptr<EngineRun> StartLanes(const PairGeometry& geometry, OrbitSource& source) {
  OrbitDevice* const device = source.FollowsTangents() ? nullptr : source.Device();
  std::unique_ptr<EngineRun> run = device == nullptr ? nullptr : device->Start(geometry, source);
  return run == nullptr ? StartLaneOrbits(geometry, source) : std::move(run);
}

}  // namespace

void Collision::Add(const Event& event) {
  time += event.duration;
  ball_wall_hits += event.kind == EventKind::kBallWall;
  piston_wall_hits += event.kind == EventKind::kPistonWall;
  escaped = event.kind == EventKind::kEscape;
}

std::unique_ptr<EngineRun> StartOrbits(Engine engine, const PairGeometry& geometry,
                                       OrbitSource& source) {
  if (engine == Engine::kLanes) return StartLanes(geometry, source);
  if (engine == Engine::kLanesSingle) return StartLaneOrbitsSingle(geometry, source);
  return std::make_unique<ReferenceOrbits>(geometry, source);
}

}  // namespace ballpiston
