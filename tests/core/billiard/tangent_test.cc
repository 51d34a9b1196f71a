// Tangent vectors against differences of nearby orbits in 256 bits, and those of the lanes against
// those of the reference.
#include <type_traits>

#include "core/billiard/orbits.h"
#include "core/billiard/tangent_frame.h"
#include "core/billiard/tangent_plane.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tools/flows/precise_flow.h"

namespace ballpiston {
namespace {

// ---- nearby orbits ----

using Flow = EventFlow<TwinNumber>;
using Difference = std::array<TwinNumber, 6>;

// The components x, y, q, vx, vy, p.
Difference ComponentsOf(const Flow::State& state) {
  return {state.position.x(),
          state.position.y(),
          state.piston,
          state.ball_speed * state.direction.x(),
          state.ball_speed * state.direction.y(),
          state.piston_velocity};
}

TwinNumber Product(const Difference& a, const Difference& b) {
  TwinNumber sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// With these velocities, to 256 bits.
Flow::State WithVelocities(Flow::State state, const TwinNumber& vx, const TwinNumber& vy,
                           const TwinNumber& p) {
  state.ball_speed = sqrt(vx * vx + vy * vy);
  state.direction = {vx / state.ball_speed, vy / state.ball_speed};
  state.piston_velocity = p;
  return state;
}

PairState Rounded(const Flow::State& state) {
  const auto number = [](const TwinNumber& x) { return x.convert_to<double>(); };
  return {.position = {number(state.position.x()), number(state.position.y())},
          .direction = {number(state.direction.x()), number(state.direction.y())},
          .ball_speed = number(state.ball_speed),
          .piston = number(state.piston),
          .piston_velocity = number(state.piston_velocity)};
}

// An orbit after a number of events, and then a flight to a given time.
class TimedOrbit {
 public:
  TimedOrbit(const PairGeometry& geometry, const Flow::State& start) : flow_(geometry, start) {}

  EventOf<TwinNumber> Step() {
    const EventOf<TwinNumber> event = flow_.Step();
    time_ += event.duration;
    return event;
  }
  void ExchangeComponents() { flow_.ExchangeComponents(); }

  const Flow::State& state() const { return flow_.state(); }
  const TwinNumber& time() const { return time_; }

  Difference At(const TwinNumber& time) const {
    Difference components = ComponentsOf(flow_.state());
    for (size_t i = 0; i < 3; ++i) components[i] += (time - time_) * components[i + 3];
    return components;
  }

 private:
  Flow flow_;
  TwinNumber time_ = 0;
};

struct Growths {
  double first = 0, second = 0;
};

constexpr double kApart = 1e-60;

// The start, moved by kApart in the direction of one of the frame's first two vectors.
Flow::State Moved(const Flow::State& start, bool along_second) {
  const TwinNumber &ux = start.direction.x(), &uy = start.direction.y();
  const TwinNumber &v = start.ball_speed, &p = start.piston_velocity;
  const TwinNumber h = kApart;
  if (along_second)
    return WithVelocities(start, v * ux + h * p * ux, v * uy + h * p * uy, p - h * v);
  return WithVelocities(start, v * ux - h * uy, v * uy + h * ux, p);
}

// The growth of the first distance, and of the area of two, over the first.
Growths OfNearbyOrbits(const Difference& base, const Difference& first, const Difference& second) {
  Difference a, b;
  for (size_t i = 0; i < base.size(); ++i) {
    a[i] = (first[i] - base[i]) / kApart;
    b[i] = (second[i] - base[i]) / kApart;
  }
  const TwinNumber aa = Product(a, a), ab = Product(a, b);
  const TwinNumber rest = Product(b, b) - ab * ab / aa;
  return {std::log(aa.convert_to<double>()) / 2, std::log(rest.convert_to<double>()) / 2};
}

// The growths of tangent vectors and of nearby orbits over `collisions` collisions of an orbit.
std::array<Growths, 2> GrowthsOver(int collisions, const PairGeometry& geometry, uint64_t seed) {
  CounterRandom random(seed, 0, 0);
  const PairState drawn = DrawFromCollisionMeasure(geometry, random);
  const TwinNumber p = drawn.piston_velocity, v = sqrt(1 - p * p);
  Flow::State start = {.position = {drawn.position.x(), drawn.position.y()},
                       .piston = drawn.piston};
  const TwinNumber ux = drawn.direction.x(), uy = drawn.direction.y();
  const TwinNumber length = sqrt(ux * ux + uy * uy);
  start = WithVelocities(start, v * ux / length, v * uy / length, p);

  TimedOrbit base(geometry, start), first(geometry, Moved(start, false)),
      second(geometry, Moved(start, true));
  TangentFrame frame(geometry, drawn);
  while (collisions > 0) {
    const EventOf<TwinNumber> event = base.Step();
    frame.Follow({event.kind, event.duration.convert_to<double>()}, Rounded(base.state()));
    EXPECT_EQ(first.Step().kind, event.kind);
    EXPECT_EQ(second.Step().kind, event.kind);
    if (event.kind != EventKind::kBallPiston) continue;
    for (TimedOrbit* orbit : {&base, &first, &second}) orbit->ExchangeComponents();
    frame.Collide({});
    --collisions;
  }
  const auto growth = frame.TakeGrowth();
  const TwinNumber& now = base.time();
  return {Growths{growth[0], growth[1]},
          OfNearbyOrbits(base.At(now), first.At(now), second.At(now))};
}

// Distances are accurate to 256 bits, 1e-77, and to their square. So the growth by exp(40), to
// 1e-43, is measured to ten digits or more. An orbit with a longer wait would need more bits.
TEST(TangentFrame, NearbyOrbitsDivergeAsPredicted) {
  int compared = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const auto [tangent, nearby] = GrowthsOver(2, GeometryOf(0.53, 0.3), seed);
    if (tangent.first > 40) continue;
    ++compared;
    EXPECT_NEAR(tangent.first, nearby.first, 1e-8 * nearby.first);
    EXPECT_NEAR(tangent.second, nearby.second, 1e-8 * std::fabs(nearby.second));
  }
  EXPECT_GE(compared, 5);
}

// ---- lanes and reference ----

constexpr size_t kCollisions = 4;

struct Followed {
  std::array<Growths, kCollisions> growths = {};
  size_t collisions = 0;
  uint64_t hits = 0;
};

template <typename Tangents>
class RecordedGrowths : public OrbitSource {
 public:
  RecordedGrowths(Engine engine, const PairGeometry& geometry, size_t orbits)
      : geometry_(geometry), orbits_(orbits), tangents_(orbits) {
    StartOrbits(engine, geometry, *this)->Advance();
  }
  const std::vector<Followed>& orbits() const { return orbits_; }

 private:
  size_t Start(std::span<OrbitStart> starts) override {
    size_t n = 0;
    for (; n < starts.size() && started_ < orbits_.size(); ++n, ++started_) {
      CounterRandom random(1, 2, started_);
      starts[n] = {started_, DrawFromCollisionMeasure(geometry_, random)};
      tangents_[started_] = Tangents(geometry_, starts[n].state);
    }
    return n;
  }

  void Collide(std::span<OrbitCollision> collisions) override {
    for (auto& [index, collision, after] : collisions) {
      tangents_[index].Collide(collision);
      const auto growth = tangents_[index].TakeGrowth();
      Followed& orbit = orbits_[index];
      orbit.growths[orbit.collisions++] = {growth[0], growth[1]};
      orbit.hits += collision.ball_wall_hits;
      after = orbit.collisions < kCollisions ? AfterCollision::kGoOn : AfterCollision::kEnd;
    }
  }

  bool FollowsTangents() const override { return true; }
  void FollowEvent(uint64_t orbit, const Event& event, const PairState& after) override {
    if constexpr (std::is_same_v<Tangents, TangentFrame>) tangents_[orbit].Follow(event, after);
  }
  void FollowWait(uint64_t orbit, const BallMap& flights) override {
    if constexpr (std::is_same_v<Tangents, TangentPlane>) tangents_[orbit].Follow(flights);
  }
  bool Pause() override { return false; }

  PairGeometry geometry_;
  std::vector<Followed> orbits_;
  std::vector<Tangents> tangents_;
  size_t started_ = 0;
};

// Orbits of both engines agree for about 30 wall hits. Some of them have four collisions until
// then. The third wait is the first one to which the signs of wall hits matter.
TEST(TangentPlane, TheReflectionOfAnExchangeIsThatOfSixComponents) {
  constexpr uint64_t kMostHits = 16;
  const PairGeometry geometry = GeometryOf(0.53, 0.3);
  const RecordedGrowths<TangentFrame> reference(Engine::kReference, geometry, 5000);
  const RecordedGrowths<TangentPlane> lanes(Engine::kLanes, geometry, 5000);
  size_t compared = 0;
  for (size_t i = 0; i < reference.orbits().size(); ++i) {
    const Followed &expected = reference.orbits()[i], &orbit = lanes.orbits()[i];
    if (expected.hits > kMostHits) continue;
    ++compared;
    EXPECT_EQ(orbit.hits, expected.hits);
    for (size_t k = 0; k < kCollisions; ++k) {
      EXPECT_NEAR(orbit.growths[k].first, expected.growths[k].first, 1e-5);
      EXPECT_NEAR(orbit.growths[k].second, expected.growths[k].second, 1e-5);
    }
  }
  EXPECT_GT(compared, 50u);
}

// Two vectors after a wait with this map, and after a second wait of the same kind.
std::array<double, 2> GrowthWithExponent(double exponent) {
  const Collision collision = {
      .state = {.direction = {0.6, 0.8}, .ball_speed = 0.8, .piston_velocity = -0.6},
      .time = 50,
      .ball_wall_hits = 7,
      .piston_wall_hits = 2};
  TangentPlane plane;
  for (int wait = 0; wait < 2; ++wait) {
    plane.Follow({.aa = 0.9, .at = 0.2, .ta = 1.7, .tt = 0.4, .exponent = exponent});
    plane.Collide(collision);
  }
  return plane.TakeGrowth();
}

// The second vector does not notice how much longer the first one is.
TEST(TangentPlane, LongWaitsNeedNoRangeOfExponents) {
  const auto long_wait = GrowthWithExponent(60), longest = GrowthWithExponent(1e6);
  EXPECT_NEAR(longest[0] - long_wait[0], 2 * (1e6 - 60) * std::numbers::ln2, 1e-9);
  EXPECT_NEAR(longest[1], long_wait[1], 1e-12);
}

}  // namespace
}  // namespace ballpiston
