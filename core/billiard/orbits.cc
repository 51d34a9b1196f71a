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
    OrbitStart start;
    if (source_.Start({&start, 1}) == 0) return false;
    flow_.emplace(geometry_, start.state);
    current_ = {.orbit = start.orbit};
    longest_ = HasTimeLimit() ? limit_ : longest_wait_.From(start.state);
    return true;
  }
  bool HasTimeLimit() const { return limit_ < std::numeric_limits<double>::infinity(); }

  void Step() {
    Collision& collision = current_.collision;
    const Event event = flow_->Step();
    collision.Add(event);
    if (follows_tangents_) source_.FollowEvent(current_.orbit, event, flow_->state());
    const bool is_overdue = collision.time > longest_;
    collision.expired = is_overdue && HasTimeLimit();
    collision.escaped |= is_overdue && !HasTimeLimit();
    const bool has_ended = collision.escaped || collision.expired;
    if (event.kind != EventKind::kBallPiston && !has_ended) return;
    collision.state = flow_->state();
    source_.Collide({&current_, 1});
    if (current_.after == AfterCollision::kEnd || has_ended) return flow_.reset();
    flow_->ExchangeComponents();
    if (!HasTimeLimit()) longest_ = longest_wait_.From(flow_->state());
    collision = {};
  }

  PairGeometry geometry_;
  OrbitSource& source_;
  double limit_;
  bool follows_tangents_;
  LongestWait longest_wait_;
  double longest_ = 0;  // of the current wait
  std::optional<ReferenceFlow> flow_;
  OrbitCollision current_;
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
