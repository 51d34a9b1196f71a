#include "core/billiard/lane_orbits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/billiard/lane_orbits.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "core/billiard/lane_flight-inl.h"
#include "core/billiard/lane_frame.h"
#include "core/billiard/piston_wave.h"
#include "core/billiard/reference_flow.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Vectors in flight at once: a flight is a chain of some 70 cycles, of which a vector fills 12.
constexpr size_t kVectors = 6;
constexpr int kStepsBetweenLooks = 4096;  // at `stop`

// What of an orbit is not in the lanes: its sums up to where the lane's own begin.
struct LaneOrbit {
  uint64_t orbit = 0;
  double ball_speed = 1;
  double piston_speed = 0;
  Contact sums;            // without `state`
  double path = 0;         // the ball's, in lanes, since it entered them
  double entry_phase = 0;  // the piston's, then
  uint64_t entry_step = 0;
};

template <typename T>
class LaneOrbits {
 public:
  LaneOrbits(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source)
      : geometry_(geometry),
        constants_(geometry),
        wave_(geometry),
        reach_(static_cast<T>(0.5 - geometry.piston_left())),
        orbits_(orbits),
        source_(source),
        width_(hn::Lanes(D())),
        lanes_(width_ * kVectors),
        memory_(hwy::AllocateAligned<T>(lanes_ * kArrays)),
        orbit_(lanes_) {
    std::fill(memory_.get(), memory_.get() + lanes_ * kArrays, T(0));
  }

  bool Run(const std::stop_token& stop) {
    for (size_t lane = 0; lane < lanes_; ++lane) Begin(lane);
    while (running_ > 0) {
      for (int i = 0; i < kStepsBetweenLooks && running_ > 0; ++i) Step();
      if (stop.stop_requested()) return false;
    }
    return true;
  }

 private:
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;

  // One value a lane. kPath: the ball's since kPhase, the piston's phase, was taken. kReach: depth
  // up to which this lane's ball can meet the piston.
  enum Array { kH, kE, kC, kS, kA, kB, kM, kDepth, kPath, kPhase, kSpeedRatio, kReach, kArrays };

  // Rounding in the lanes must not hide a contact; what is looked at in vain costs little.
  static constexpr T kSlack = sizeof(T) == 8 ? T(1e-11) : T(1e-4);

  T* At(Array array, size_t lane) { return memory_.get() + array * lanes_ + lane; }
  V Get(Array array, size_t lane) { return hn::Load(D(), At(array, lane)); }
  void Put(V value, Array array, size_t lane) { hn::Store(value, D(), At(array, lane)); }

  void Step() {
    ++step_;
    for (size_t first = 0; first < lanes_; first += width_) FlyVector(first);
  }

  HWY_INLINE void FlyVector(size_t first) {
    const D d;
    const Ball<D> from = {Get(kH, first), Get(kE, first), Get(kC, first), Get(kS, first)};
    const Compass<D> compass = {Get(kA, first), Get(kB, first), Get(kM, first)};
    const Flight<D> flight = Fly(d, constants_, from);
    const Compass<D> turned = Turned(d, compass, flight);
    const V depth = DepthAtRightTip(d, flight.ball, turned);
    const V nearest = hn::Min(depth, Get(kDepth, first));
    const auto near = hn::Lt(nearest, Get(kReach, first));
    if (HWY_UNLIKELY(!hn::AllFalse(d, near))) {
      const auto meet = TakePhase(first, flight.length, nearest, near);
      if (HWY_UNLIKELY(!hn::AllFalse(d, meet))) {
        StoreFlight(first, flight, turned, depth);
        Resolve(first, from, compass, meet);
        return;
      }
    }
    StoreFlight(first, flight, turned, depth);
  }

  HWY_INLINE void StoreFlight(size_t first, const Flight<D>& flight, const Compass<D>& compass,
                              V depth) {
    Put(flight.ball.h, kH, first);
    Put(flight.ball.e, kE, first);
    Put(flight.ball.c, kC, first);
    Put(flight.ball.s, kS, first);
    Put(compass.a, kA, first);
    Put(compass.b, kB, first);
    Put(compass.m, kM, first);
    Put(depth, kDepth, first);
    Put(hn::Add(Get(kPath, first), flight.length), kPath, first);
  }

  // Takes the piston's phase at the beginning of the flights near it. Of these, the ones in which
  // ball and piston may meet: the piston's leftmost position is left of the ball's rightmost.
  hn::Mask<D> TakePhase(size_t first, V length, V nearest, hn::Mask<D> near) {
    const D d;
    const V period = hn::Set(d, static_cast<T>(2 * wave_.stroke()));
    const V path = Get(kPath, first), ratio = Get(kSpeedRatio, first);
    V phase = hn::MulAdd(ratio, path, Get(kPhase, first));
    const V turns = hn::Floor(hn::Mul(phase, hn::Set(d, static_cast<T>(0.5 / wave_.stroke()))));
    phase = hn::NegMulAdd(turns, period, phase);
    Put(hn::IfThenElse(near, phase, Get(kPhase, first)), kPhase, first);
    Put(hn::IfThenElse(near, hn::Zero(d), path), kPath, first);
    alignas(64) T taken[HWY_MAX_BYTES / sizeof(T)] = {};
    hn::Store(hn::IfThenElseZero(near, path), d, taken);
    for (size_t i = 0; i < width_; ++i) orbit_[first + i].path += static_cast<double>(taken[i]);
    // The wave's lowest point over the flight; below 0 if it turns at the left wall in between.
    const V end = hn::MulAdd(ratio, length, phase);
    const V lowest = hn::Min(hn::Min(phase, end), hn::Sub(period, hn::Max(phase, end)));
    const V ball = hn::Sub(hn::Set(d, reach_ + kSlack), nearest);
    return hn::And(near, hn::Lt(lowest, ball));
  }

  void Resolve(size_t first, const Ball<D>& from, const Compass<D>& compass, hn::Mask<D> meet) {
    const D d;
    const V before[] = {from.h, from.e, from.c, from.s, compass.a, compass.b, compass.m};
    alignas(64) T values[7][HWY_MAX_BYTES / sizeof(T)];
    for (size_t i = 0; i < 7; ++i) hn::Store(before[i], d, values[i]);
    alignas(64) T chosen[HWY_MAX_BYTES / sizeof(T)];
    hn::Store(hn::IfThenElseZero(meet, hn::Set(d, T(1))), d, chosen);
    for (size_t i = 0; i < width_; ++i) {
      if (chosen[i] == 0) continue;
      Leave(first + i, {values[0][i], values[1][i], values[2][i], values[3][i], values[4][i],
                        values[5][i], values[6][i]});
    }
  }

  // Out of the lanes, at the beginning of the flight that was just made.
  void Leave(size_t lane, const LaneFrame& frame) {
    LaneOrbit& orbit = orbit_[lane];
    const double phase = static_cast<double>(*At(kPhase, lane));
    orbit.sums.time += orbit.path / orbit.ball_speed;
    orbit.sums.ball_wall_hits += step_ - 1 - orbit.entry_step;
    orbit.sums.piston_wall_hits +=
        wave_.Hits(orbit.entry_phase, orbit.path * (orbit.piston_speed / orbit.ball_speed));
    FlyToWall(lane, {.position = PositionInCell(frame),
                     .direction = DirectionInCell(frame),
                     .ball_speed = orbit.ball_speed,
                     .piston = wave_.Position(phase),
                     .piston_velocity = wave_.Velocity(phase, orbit.piston_speed)});
  }

  // Event by event until the ball is on a wall, through what collisions there are.
  void FlyToWall(size_t lane, const PairState& state) {
    ReferenceFlow flow(geometry_, state);
    Contact& sums = orbit_[lane].sums;
    for (;;) {
      const Event event = flow.Step();
      sums.Add(event);
      if (event.kind == EventKind::kBallWall) return Enter(lane, flow.state());
      if (event.kind == EventKind::kPistonWall) continue;
      sums.state = flow.state();
      if (source_.Meet(orbit_[lane].orbit, sums) == AfterContact::kEnd) return End(lane);
      flow.ExchangeComponents();
      sums = {};
    }
  }

  void Enter(size_t lane, const PairState& state) {
    const LaneFrame frame = FrameOfBallOnWall(state.position, state.direction);
    const double values[] = {frame.h, frame.e, frame.c, frame.s, frame.a, frame.b, frame.m};
    for (size_t i = 0; i < 7; ++i) *At(static_cast<Array>(i), lane) = static_cast<T>(values[i]);
    LaneOrbit& orbit = orbit_[lane];
    orbit.ball_speed = state.ball_speed;
    orbit.piston_speed = std::fabs(state.piston_velocity);
    orbit.path = 0;
    orbit.entry_phase = wave_.Phase(state);
    orbit.entry_step = step_;
    *At(kDepth, lane) = static_cast<T>(frame.a < 0 ? 0.5 - state.position.x() : 4);
    *At(kPath, lane) = T(0);
    *At(kPhase, lane) = static_cast<T>(orbit.entry_phase);
    *At(kSpeedRatio, lane) = static_cast<T>(orbit.piston_speed / orbit.ball_speed);
    *At(kReach, lane) = reach_;
  }

  void Begin(size_t lane) {
    if (next_ == orbits_) return Park(lane);
    orbit_[lane] = {};
    orbit_[lane].orbit = next_;
    ++running_;
    FlyToWall(lane, source_.Start(next_++));
  }

  void End(size_t lane) {
    --running_;
    Begin(lane);
  }

  // A lane without an orbit flies back and forth between two discs, out of the piston's reach.
  void Park(size_t lane) {
    orbit_[lane] = {};
    Enter(lane,
          {.position = {-geometry_.rho() * M_SQRT1_2 + 0.5, -geometry_.rho() * M_SQRT1_2 + 0.5}});
    *At(kH, lane) = static_cast<T>(M_SQRT1_2);
    *At(kReach, lane) = T(-1);
  }

  PairGeometry geometry_;
  FlightConstants<T> constants_;
  PistonWave wave_;
  T reach_;
  uint64_t orbits_;
  OrbitSource& source_;
  size_t width_;
  size_t lanes_;
  hwy::AlignedFreeUniquePtr<T[]> memory_;
  std::vector<LaneOrbit> orbit_;
  uint64_t next_ = 0;
  uint64_t running_ = 0;
  uint64_t step_ = 0;
};

bool RunDouble(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
               const std::stop_token& stop) {
  return LaneOrbits<double>(geometry, orbits, source).Run(stop);
}

bool RunSingle(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
               const std::stop_token& stop) {
  return LaneOrbits<float>(geometry, orbits, source).Run(stop);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(RunDouble);
HWY_EXPORT(RunSingle);

bool RunLaneOrbits(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
                   const std::stop_token& stop) {
  return HWY_DYNAMIC_DISPATCH(RunDouble)(geometry, orbits, source, stop);
}

bool RunLaneOrbitsSingle(const PairGeometry& geometry, uint64_t orbits, OrbitSource& source,
                         const std::stop_token& stop) {
  return HWY_DYNAMIC_DISPATCH(RunSingle)(geometry, orbits, source, stop);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
