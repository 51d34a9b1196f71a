#include "core/billiard/lane_orbits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/billiard/lane_orbits.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/billiard/lane_flight-inl.h"
#include "core/billiard/lane_frame.h"
#include "core/billiard/piston_wave.h"
#include "core/billiard/reference_flow.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The vectors form two groups, which fly in turn. While one group flies, the engine tests the
// flights that the other group has finished. So the branch of the test depends on finished results
// only. A mispredicted branch on the newest flights would discard all operations begun after it.
constexpr size_t kGroups = 2;
constexpr size_t kVectorsInGroup = 2;
constexpr size_t kVectors = kGroups * kVectorsInGroup;
constexpr int kStepsBetweenLooks = 4096;  // between two calls of Pause; about 0.2 ms

// The part of an orbit's state that is not in its lane: the sums up to where the lane's sums begin.
struct LaneOrbit {
  uint64_t orbit = 0;
  double ball_speed = 1;
  double piston_speed = 0;
  Contact sums;            // `state` is set only while the orbit is in contact
  double path = 0;         // the ball's since it entered the lanes, less what is in its lane
  double entry_phase = 0;  // the piston's, then
  uint64_t entry_step = 0;
};

// An orbit that is not in the lanes: before its first wall, or around a collision.
struct OrbitOutside {
  OrbitOutside(const LaneOrbit& orbit_outside, const PairGeometry& geometry, const PairState& state)
      : orbit(orbit_outside), flow(geometry, state) {}

  LaneOrbit orbit;
  ReferenceFlow flow;
};

template <typename T>
class LaneOrbits : public OrbitRun {
 public:
  LaneOrbits(const PairGeometry& geometry, OrbitSource& source)
      : geometry_(geometry),
        wave_(geometry),
        constants_(geometry, wave_),
        source_(source),
        limit_(source.TimeLimit()),
        lanes_(Width() * kVectors),
        memory_(hwy::AllocateAligned<T>(lanes_ * kArrays)),
        orbit_(lanes_) {
    std::fill(memory_.get(), memory_.get() + lanes_ * kArrays, T(0));
    outside_.reserve(lanes_);
    for (size_t lane = 0; lane < lanes_; ++lane) Park(lane);
    ListIdleLanes();
  }

  bool Advance() override {
    do {
      ResumeOutside();
      for (int i = 0; i < kStepsBetweenLooks && running_ > 0; ++i) Step();
      if (limit_ < std::numeric_limits<double>::infinity()) LookAtLimits();
      if (IsDone()) return true;
    } while (!source_.Pause());
    return false;
  }

 private:
  using D = hn::ScalableTag<T>;
  static constexpr size_t K = kVectorsInGroup;
  using V = hn::Vec<D>;

  static size_t Width() { return hn::Lanes(D()); }
  static size_t LanesInGroup() { return Width() * K; }

  // One value a lane. The values that a flight changes are stored twice, before and after the
  // flight; the two arrays swap at every step. kX: the ball's distance from where the piston can
  // reach it. kPhase: the piston's phase, in periods. kPath: the ball's path since it was last
  // taken out. kRatio: periods of the piston in a unit of path.
  enum Array {
    kH,
    kE,
    kC,
    kS,
    kA,
    kB,
    kM,
    kX,
    kPhase,
    kPath,
    kFlying,
    kRatio = 2 * kFlying,
    kArrays
  };

  // Rounding in the lanes must not hide a contact; a false alarm costs little.
  static constexpr double kSlack = sizeof(T) == 8 ? 1e-11 : 1e-3;
  // Single precision sums short paths only.
  static constexpr T kLongestPath = T(256);

  // The largest c'^2 - 2 that is taken for rounding, which makes some ulps. The same comparison
  // finds contacts and escapes, so this value has to be small compared with kSlack.
  static constexpr T kMissedByRounding = sizeof(T) == 8 ? T(1e-12) : T(1e-5);

  static constexpr int kMostRounds = 256;  // of contacts, some 1 ms

  struct Constants {
    Constants(const PairGeometry& geometry, const PistonWave& wave) : flight(geometry) {
      const double square = flight.scale * flight.scale;
      left = static_cast<T>(square * (wave.left() - kSlack));
      period = static_cast<T>(square * 2 * wave.stroke());
    }
    FlightConstants<T> flight;
    T left;  // from here on the piston can reach the ball
    T period;
  };

  static HWY_INLINE uint64_t Bits(hn::Mask<D> mask) {
    uint8_t low, high = 0;  // of 16 lanes at most
    if constexpr (hn::MaxLanes(D()) > 8) {
      uint8_t bytes[2];
      hn::StoreMaskBits(D(), mask, bytes);
      low = bytes[0];
      high = bytes[1];
    } else {
      hn::StoreMaskBits(D(), mask, &low);
    }
    return low | uint64_t{high} << 8;
  }

  // The memory lies group by group, then array by array.
  T* At(size_t array, size_t lane) {
    return memory_.get() + (GroupOf(lane) * kArrays + array) * LanesInGroup() +
           lane % LanesInGroup();
  }

  // A group has made step_[group] flights; the parity tells where the newest state is.
  static size_t GroupOf(size_t lane) { return lane / LanesInGroup(); }
  size_t Newest(size_t group) const { return (step_[group] % 2) * kFlying; }
  // Before and after the lane's last flight.
  T& After(Array array, size_t lane) { return *At(array + Newest(GroupOf(lane)), lane); }
  T& Before(Array array, size_t lane) { return *At(array + kFlying - Newest(GroupOf(lane)), lane); }

  bool IsDone() const {
    return source_is_empty_ && running_ == 0 && outside_.empty() && slow_.empty();
  }

  void Step() {
    FlyGroup(0);
    LookAtGroup(1);
    if (HWY_LIKELY(groups_ == kGroups)) FlyGroup(1);
    LookAtGroup(0);
    if (HWY_UNLIKELY(running_ + LanesInGroup() <= groups_ * LanesInGroup())) Compact();
  }

  HWY_INLINE void FlyGroup(size_t group) {
    const Constants constants = constants_;  // a copy that no store into the lanes can change
    T* lanes = memory_.get() + group * kArrays * LanesInGroup();
    const T* from = lanes + Newest(group) * LanesInGroup();
    T* to = lanes + (kFlying - Newest(group)) * LanesInGroup();
    ++step_[group];
    FlyOnce(constants, from, to, lanes + kRatio * LanesInGroup(), flags_[group]);
  }

  static HWY_INLINE void Get(const T* lanes, Array array, V (&v)[K]) {
    BALLPISTON_EACH v[i] = hn::Load(D(), lanes + array * LanesInGroup() + i * Width());
  }
  static HWY_INLINE void Put(const V (&v)[K], T* lanes, Array array) {
    BALLPISTON_EACH { hn::Store(v[i], D(), lanes + array * LanesInGroup() + i * Width()); }
  }

  static HWY_INLINE void FlyOnce(const Constants& k, const T* from, T* to, const T* ratios,
                                 uint64_t& flags) {
    const D d;
    V length[K], missed[K], x[K], path[K];
    Balls<D, K> balls;
    Get(from, kH, balls.h);
    Get(from, kE, balls.e);
    Get(from, kC, balls.c);
    Get(from, kS, balls.s);
    Get(from, kA, balls.a);
    Get(from, kB, balls.b);
    Get(from, kM, balls.m);
    Fly(d, k.flight, balls, length, missed);
    Put(balls.h, to, kH);
    Put(balls.e, to, kE);
    Put(balls.c, to, kC);
    Put(balls.s, to, kS);
    Put(balls.a, to, kA);
    Put(balls.b, to, kB);
    Put(balls.m, to, kM);
    Abscissae(d, k.flight, balls, k.left, x);
    Put(x, to, kX);
    Get(from, kPath, path);
    BALLPISTON_EACH path[i] = hn::Add(path[i], length[i]);
    Put(path, to, kPath);
    MovePistons(k, from, to, ratios, length, missed, x, flags);
    if constexpr (sizeof(T) == 4) FlagLongPaths(path, flags);
  }

  // `flags` marks the lanes to look at: ball and piston met, or may have met, or the ball has left
  // the cell. The distance between ball and piston is a concave function of time, except where the
  // piston turns at its left wall. So they met if the ball ends beyond the piston, and may have met
  // if the piston turned while the ball was in its reach.
  static HWY_INLINE void MovePistons(const Constants& k, const T* from, T* to, const T* ratios,
                                     const V (&length)[K], const V (&missed)[K], const V (&x)[K],
                                     uint64_t& flags) {
    const D d;
    V phase[K], turns[K], ratio[K], before[K], way[K], ball[K];
    BALLPISTON_EACH ratio[i] = hn::Load(d, ratios + i * Width());
    Get(from, kPhase, phase);
    BALLPISTON_EACH phase[i] = hn::MulAdd(ratio[i], length[i], phase[i]);
    BALLPISTON_EACH turns[i] = hn::Floor(phase[i]);
    BALLPISTON_EACH phase[i] = hn::Sub(phase[i], turns[i]);
    Put(phase, to, kPhase);
    Get(from, kX, before);
    BALLPISTON_EACH way[i] = hn::Min(phase[i], hn::Sub(hn::Set(d, T(1)), phase[i]));
    BALLPISTON_EACH ball[i] = hn::NegMulAdd(way[i], hn::Set(d, k.period), x[i]);
    BALLPISTON_EACH turns[i] = hn::Min(turns[i], hn::Max(x[i], before[i]));
    BALLPISTON_EACH ball[i] = hn::Max(ball[i], turns[i]);
    BALLPISTON_EACH ball[i] = hn::Max(ball[i], missed[i]);
    uint64_t bits = 0;
    BALLPISTON_EACH bits |= Bits(hn::Gt(ball[i], hn::Set(d, kMissedByRounding))) << (i * Width());
    flags = bits;
  }

  static HWY_INLINE void FlagLongPaths(const V (&path)[K], uint64_t& flags) {
    BALLPISTON_EACH { flags |= Bits(hn::Gt(path[i], hn::Set(D(), kLongestPath))) << (i * Width()); }
  }

  void LookAtGroup(size_t group) {
    if (HWY_LIKELY(flags_[group] == 0)) return;
    LookAtFlagged(group);
  }

  // Not inlined, so that the loop of flights stays small.
  HWY_NOINLINE void LookAtFlagged(size_t group) {
    for (uint64_t bits = std::exchange(flags_[group], 0); bits != 0; bits &= bits - 1) {
      LookAt(group * LanesInGroup() + hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
    }
    FlyOutside();
  }

  // At the lane's last flight.
  void LookAt(size_t lane) {
    if (HasEscaped(lane)) return Escape(lane);
    if (MeetOnTheWay(lane)) return Leave(lane);
    orbit_[lane].path += static_cast<double>(After(kPath, lane));
    After(kPath, lane) = 0;
  }

  bool HasEscaped(size_t lane) {
    const T c = After(kC, lane);
    return !(c * c - 2 <= kMissedByRounding);
  }

  void Escape(size_t lane) {
    orbit_[lane].sums.escaped = true;
    EndInLane(lane);
  }

  bool MeetOnTheWay(size_t lane) {
    const double x0 = Before(kX, lane), x1 = After(kX, lane);
    const double phase0 = Before(kPhase, lane), phase1 = After(kPhase, lane);
    if (x1 > std::min(phase1, 1 - phase1) * constants_.period) return true;
    const double length = static_cast<double>(After(kPath, lane)) - Before(kPath, lane);
    const double way = *At(kRatio, lane) * length;
    if (!(phase0 + way > 1 - kSlack)) return false;
    // The first and the last moment of the flight when the piston was at its left wall.
    const double first = std::clamp((1 - phase0) / way, 0.0, 1.0);
    const double last = std::clamp(1 - phase1 / way, 0.0, 1.0);
    return std::max(x0 + first * (x1 - x0), x0 + last * (x1 - x0)) > 0;
  }

  // Out of the lanes, at the beginning of the last flight.
  void Leave(size_t lane) {
    LaneOrbit& orbit = orbit_[lane];
    const double phase = Before(kPhase, lane) * 2 * wave_.stroke();
    const double path = (orbit.path + Before(kPath, lane)) / constants_.flight.scale;
    orbit.sums.time += path / orbit.ball_speed;
    orbit.sums.ball_wall_hits += step_[GroupOf(lane)] - 1 - orbit.entry_step;
    orbit.sums.piston_wall_hits +=
        wave_.Hits(orbit.entry_phase, path * (orbit.piston_speed / orbit.ball_speed));
    const LaneFrame frame =
        Scaled({Before(kH, lane), Before(kE, lane), Before(kC, lane), Before(kS, lane),
                Before(kA, lane), Before(kB, lane), Before(kM, lane)},
               1 / constants_.flight.scale);
    const PairState state = {.position = PositionInCell(frame),
                             .direction = DirectionInCell(frame),
                             .ball_speed = orbit.ball_speed,
                             .piston = wave_.Position(phase),
                             .piston_velocity = wave_.Velocity(phase, orbit.piston_speed)};
    outside_.emplace_back(orbit, geometry_, state);
    Empty(lane);
  }

  void Empty(size_t lane) {
    orbit_[lane].orbit = kNoOrbit;
    idle_.push_back(lane);
    --running_;
  }

  // ---- orbits outside of the lanes ----

  // Called between steps: advances slow orbits and starts new ones.
  void ResumeOutside() {
    outside_.insert(outside_.end(), slow_.begin(), slow_.end());
    slow_.clear();
    source_is_empty_ = false;
    StartNew();
    FlyOutside();
  }

  // Advances each orbit event by event, through any collisions, until it is on a wall or has taken
  // too long. A ball at rest never reaches a wall, so the number of rounds between two calls of
  // Pause has a limit.
  void FlyOutside() {
    for (int round = 0; !outside_.empty() && round < kMostRounds; ++round) {
      FlyToContacts();
      if (!meetings_.empty()) source_.Meet(meetings_);
      Depart();
      StartNew();
    }
    for (; parked_ < idle_.size(); ++parked_) Park(idle_[parked_]);
  }

  // Afterwards all orbits outside are in contact; `meetings_` has their contacts in the same order.
  void FlyToContacts() {
    meetings_.clear();
    size_t in_contact = 0;
    for (OrbitOutside& outside : outside_) {
      switch (FlyToContact(outside)) {
        case Flight::kOnWall:
          Enter(outside);
          break;
        case Flight::kInContact:
          meetings_.push_back({outside.orbit.orbit, outside.orbit.sums});
          if (&outside_[in_contact] != &outside) outside_[in_contact] = outside;
          ++in_contact;
          break;
        case Flight::kSlow:
          slow_.push_back(outside);
          break;
      }
    }
    outside_.erase(outside_.begin() + static_cast<std::ptrdiff_t>(in_contact), outside_.end());
  }

  enum class Flight { kOnWall, kInContact, kSlow };

  // The piston may turn many times before a slow ball reaches anything.
  Flight FlyToContact(OrbitOutside& outside) {
    Contact& sums = outside.orbit.sums;
    for (int events = 0; events < kStepsBetweenLooks; ++events) {
      const Event event = outside.flow.Step();
      sums.Add(event);
      if (event.kind == EventKind::kBallWall) return Flight::kOnWall;
      sums.expired = sums.time > limit_;
      if (event.kind == EventKind::kPistonWall && !sums.expired) continue;
      sums.state = outside.flow.state();
      return Flight::kInContact;
    }
    return Flight::kSlow;
  }

  // Each orbit in contact continues or ends.
  void Depart() {
    size_t going_on = 0;
    for (size_t i = 0; i < outside_.size(); ++i) {
      const Contact& contact = outside_[i].orbit.sums;
      if (meetings_[i].after == AfterContact::kEnd || contact.escaped || contact.expired) continue;
      if (going_on != i) outside_[going_on] = outside_[i];
      outside_[going_on].flow.ExchangeComponents();
      outside_[going_on].orbit.sums = {};
      ++going_on;
    }
    outside_.erase(outside_.begin() + static_cast<std::ptrdiff_t>(going_on), outside_.end());
  }

  void StartNew() {
    const size_t room = lanes_ - running_ - outside_.size() - slow_.size();
    if (source_is_empty_ || room == 0) return;
    starts_.resize(room);
    const size_t started = source_.Start(starts_);
    source_is_empty_ = started < room;
    for (size_t i = 0; i < started; ++i) {
      LaneOrbit orbit;
      orbit.orbit = starts_[i].orbit;
      outside_.emplace_back(orbit, geometry_, starts_[i].state);
    }
  }

  // ---- between outside and the lanes ----

  void Enter(const OrbitOutside& outside) {
    const size_t lane = idle_.back();
    idle_.pop_back();
    parked_ = std::min(parked_, idle_.size());
    ++running_;
    if (GroupOf(lane) >= groups_) groups_ = kGroups;
    orbit_[lane] = outside.orbit;
    // The lane's last flight belongs to another orbit.
    flags_[GroupOf(lane)] &= ~(uint64_t{1} << (lane % LanesInGroup()));
    Place(lane, outside.flow.state());
  }

  void Place(size_t lane, const PairState& state) {
    LaneOrbit& orbit = orbit_[lane];
    orbit.ball_speed = state.ball_speed;
    orbit.piston_speed = std::fabs(state.piston_velocity);
    orbit.path = 0;
    orbit.entry_phase = wave_.Phase(state);
    orbit.entry_step = step_[GroupOf(lane)];
    const double scale = constants_.flight.scale, period = 2 * wave_.stroke();
    const LaneFrame f = Scaled(FrameOfBallOnWall(state.position, state.direction), scale);
    const double x = scale * scale * state.position.x() - constants_.left;
    const double values[kFlying] = {
        f.h, f.e, f.c, f.s, f.a, f.b, f.m, x, orbit.entry_phase / period, 0};
    for (size_t i = 0; i < kFlying; ++i) {
      After(static_cast<Array>(i), lane) = static_cast<T>(values[i]);
    }
    *At(kRatio, lane) = static_cast<T>(orbit.piston_speed / orbit.ball_speed / (scale * period));
  }

  // A lane without an orbit flies between two discs; its piston stands at the right wall.
  void Park(size_t lane) {
    const double x = 0.5 - geometry_.rho() * M_SQRT1_2;
    orbit_[lane] = LaneOrbit();
    orbit_[lane].orbit = kNoOrbit;
    Place(lane, {.position = {x, x},
                 .direction = {-M_SQRT1_2, -M_SQRT1_2},
                 .ball_speed = 1,
                 .piston = geometry_.piston_right()});
  }

  // ---- time limits ----

  // Between steps.
  void LookAtLimits() {
    LookAtGroup(1);
    for (size_t lane = 0; lane < groups_ * LanesInGroup(); ++lane) {
      if (orbit_[lane].orbit != kNoOrbit && Elapsed(lane) > limit_) Expire(lane);
    }
  }

  double Elapsed(size_t lane) {
    const LaneOrbit& orbit = orbit_[lane];
    const double path = orbit.path + static_cast<double>(After(kPath, lane));
    return orbit.sums.time + path / constants_.flight.scale / orbit.ball_speed;
  }

  void Expire(size_t lane) {
    orbit_[lane].sums.time = Elapsed(lane);
    orbit_[lane].sums.expired = true;
    EndInLane(lane);
  }

  void EndInLane(size_t lane) {
    if (orbit_[lane].orbit == kNoOrbit) return Park(lane);
    Meeting end = {orbit_[lane].orbit, orbit_[lane].sums};
    Empty(lane);
    source_.Meet({&end, 1});
  }

  // ---- the last orbits ----

  // Brings the orbits that are left into the first group. Between steps.
  void Compact() {
    LookAtGroup(1);
    if (running_ > LanesInGroup()) return;
    groups_ = 1;
    size_t from = LanesInGroup();
    for (size_t to = 0; to < LanesInGroup(); ++to) {
      if (orbit_[to].orbit != kNoOrbit) continue;
      while (from < lanes_ && orbit_[from].orbit == kNoOrbit) ++from;
      if (from == lanes_) break;
      Move(from, to);
    }
    ListIdleLanes();
  }

  // The groups need not have made as many steps: the first one flew alone before.
  void Move(size_t from, size_t to) {
    std::swap(orbit_[from], orbit_[to]);
    orbit_[to].entry_step += step_[GroupOf(to)] - step_[GroupOf(from)];
    for (size_t i = 0; i < kFlying; ++i) {
      const auto array = static_cast<Array>(i);
      std::swap(After(array, from), After(array, to));
      std::swap(Before(array, from), Before(array, to));
    }
    std::swap(*At(kRatio, from), *At(kRatio, to));
  }

  // The first lanes are taken first.
  void ListIdleLanes() {
    idle_.clear();
    for (size_t lane = lanes_; lane-- > 0;) {
      if (orbit_[lane].orbit == kNoOrbit) idle_.push_back(lane);
    }
    parked_ = idle_.size();
  }

  static constexpr uint64_t kNoOrbit = ~uint64_t{0};

  PairGeometry geometry_;
  PistonWave wave_;
  Constants constants_;
  OrbitSource& source_;
  double limit_;  // time without a collision
  size_t lanes_;
  hwy::AlignedFreeUniquePtr<T[]> memory_;
  std::vector<LaneOrbit> orbit_;
  size_t groups_ = kGroups;  // that are flown
  uint64_t step_[kGroups] = {};
  uint64_t flags_[kGroups] = {};  // a bit a lane: to be looked at
  size_t running_ = 0;            // orbits in the lanes
  std::vector<size_t> idle_;      // lanes without an orbit
  size_t parked_ = 0;             // the first parked_ of idle_ are parked
  std::vector<OrbitOutside> outside_;
  std::vector<OrbitOutside> slow_;  // also outside; they need long to reach a wall
  bool source_is_empty_ = false;    // at the last call of Start
  std::vector<Meeting> meetings_;
  std::vector<OrbitStart> starts_;
};

std::unique_ptr<OrbitRun> StartDouble(const PairGeometry& geometry, OrbitSource& source) {
  return std::make_unique<LaneOrbits<double>>(geometry, source);
}

std::unique_ptr<OrbitRun> StartSingle(const PairGeometry& geometry, OrbitSource& source) {
  return std::make_unique<LaneOrbits<float>>(geometry, source);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(StartDouble);
HWY_EXPORT(StartSingle);

std::unique_ptr<OrbitRun> StartLaneOrbits(const PairGeometry& geometry, OrbitSource& source) {
  return HWY_DYNAMIC_DISPATCH(StartDouble)(geometry, source);
}

std::unique_ptr<OrbitRun> StartLaneOrbitsSingle(const PairGeometry& geometry, OrbitSource& source) {
  return HWY_DYNAMIC_DISPATCH(StartSingle)(geometry, source);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
