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

// The vectors form three parts. While one part aims, the part before it turns, kLag vectors later
// in each stage (lane_flight-inl.h), and the engine looks at the flights of the third, which are
// done. So the branches of a look depend on finished results only: a mispredicted branch on the
// newest flights would discard all operations begun after it.
constexpr size_t kParts = 3;
constexpr size_t kVectorsInPart = 4;
constexpr size_t kLag = 2;
constexpr size_t kVectors = kParts * kVectorsInPart;
static_assert(2 * kLag == kVectorsInPart);
constexpr int kRoundsBetweenLooks = 2048;  // between two calls of Pause; about 0.2 ms

// The part of an orbit's state that is not in its lane: the sums up to where the lane's sums begin.
struct LaneOrbit {
  uint64_t orbit = 0;
  double ball_speed = 1;
  double piston_speed = 0;
  Contact sums;               // `state` is set only while the orbit is in contact
  double path = 0;            // the ball's since it entered the lanes, less what is in its lane
  double entry_phase = 0;     // the piston's, then
  uint64_t entry_flight = 0;  // the number of flights that the lane had made
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
        vectors_(hwy::MakeUniqueAlignedArray<Vector>(kVectors)),
        orbit_(Width() * kVectors) {
    outside_.reserve(orbit_.size());
    for (size_t lane = 0; lane < orbit_.size(); ++lane) Park(lane);
    ListIdleLanes();
  }

  bool Advance() override {
    do {
      ResumeOutside();
      FlyLanes();
      if (limit_ < std::numeric_limits<double>::infinity()) LookAtLimits();
      if (IsDone()) return true;
    } while (!source_.Pause());
    return false;
  }

 private:
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;
  using Column = T[kMostLanes<T>];

  static size_t Width() { return hn::Lanes(D()); }
  static size_t LanesInPart() { return Width() * kVectorsInPart; }

  // Twice what a flight changes: before and after it. The parity of the flights of the vector's
  // part tells which is which.
  struct Vector {
    Balls<T> balls[2] = {};
    HWY_ALIGN Column path[2] = {};  // the ball's since `phase` was set
    HWY_ALIGN Column phase = {};    // the piston's when the path was 0, in periods
    HWY_ALIGN Column ratio = {};    // periods of the piston in a unit of path
    Flight<T> flight = {};
    uint32_t in_reach[2] = {};  // lanes whose ball is where the piston can be
    uint32_t suspects = 0;      // lanes where something may have happened in the last flight
  };

  // Rounding in the lanes must not hide a contact; a false alarm costs little.
  static constexpr double kSlack = sizeof(T) == 8 ? 1e-11 : 1e-3;
  // A longer path is taken out, and a new phase set: sums of short paths have little rounding.
  static constexpr T kLongestPath = T(64);

  // The largest c'^2 - 2 that is taken for rounding, which makes some ulps. It has to be small
  // compared with kSlack.
  static constexpr T kMissedByRounding = sizeof(T) == 8 ? T(1e-12) : T(1e-5);

  static constexpr int kMostRounds = 256;   // of contacts, some 1 ms
  static constexpr int kMostEvents = 4096;  // of a slow orbit, between two calls of Pause
  static constexpr uint32_t kAllLanes = (uint64_t{1} << hn::MaxLanes(D())) - 1;

  struct Constants {
    Constants(const PairGeometry& geometry, const PistonWave& wave) : flight(geometry) {
      const double square = flight.scale * flight.scale;
      left = square * (wave.left() - kSlack);
      tip = static_cast<T>(square / 2 - left);
      period = static_cast<T>(square * 2 * wave.stroke());
      // At most as far as the middle of an arc, which no other half of an arc is beyond.
      const double middle = square / 2 - flight.scale;
      one_tip = left > middle ? ~uint32_t{0} : 0;
    }
    FlightConstants<T> flight;
    double left;  // from here on the piston can reach the ball
    T tip;        // from there to the disc's centre
    T period;
    uint32_t one_tip;  // all bits, if the piston reaches less than half of an arc
  };

  // Where a lane is.
  static size_t PartOf(size_t lane) { return lane / LanesInPart(); }
  Vector& VectorOf(size_t lane) { return vectors_[lane / Width()]; }
  static size_t InVector(size_t lane) { return lane % Width(); }
  // The newest state, and the one before.
  size_t After(size_t lane) const { return flights_[PartOf(lane)] % 2; }
  size_t Before(size_t lane) const { return 1 - After(lane); }

  bool IsDone() const {
    return source_is_empty_ && running_ == 0 && outside_.empty() && slow_.empty();
  }

  // ---- flights ----

  // So many rounds, a flight of each lane in a round; fewer if no orbits are left.
  void FlyLanes() {
    for (int rounds = kRoundsBetweenLooks; rounds > 0 && running_ > 0;) {
      if (running_ <= LanesInPart()) Compact();
      if (parts_ == 1) {
        FlyFirstPart();
        --rounds;
      } else {
        FlyAllParts(rounds);
      }
    }
  }

  void FlyFirstPart() {
    const Constants k = constants_;  // a copy that no store into the lanes can change
    for (size_t i = 0; i < kVectorsInPart; ++i) AimOf(k, 0, i);
    for (size_t i = 0; i < kVectorsInPart; ++i) FindRootOf(0, i);
    for (size_t i = 0; i < kVectorsInPart; ++i) TurnOf(k, 0, i);
    ++flights_[0];
    LookAtPart(0);
  }

  // Ends early if one part is enough for the orbits that are left.
  void FlyAllParts(int& rounds) {
    BeginLastPart();
    do {
      FlyOn<0>();
      LookAtPart(1);
      FlyOn<1>();
      LookAtPart(2);
      FlyOn<2>();
      LookAtPart(0);
    } while (--rounds > 0 && running_ > LanesInPart());
    EndLastPart();
    LookAtPart(1);
    LookAtPart(2);
  }

  void BeginLastPart() {
    const Constants k = constants_;
    for (size_t i = 0; i < kVectorsInPart; ++i) AimOf(k, kParts - 1, i);
    for (size_t i = 0; i < kLag; ++i) FindRootOf(kParts - 1, i);
  }

  void EndLastPart() {
    const Constants k = constants_;
    for (size_t i = kLag; i < kVectorsInPart; ++i) FindRootOf(kParts - 1, i);
    for (size_t i = 0; i < kVectorsInPart; ++i) TurnOf(k, kParts - 1, i);
    ++flights_[kParts - 1];
  }

  // Begins a flight of part P, and ends that of the part before it.
  template <size_t P>
  HWY_INLINE void FlyOn() {
    constexpr size_t kBefore = (P + kParts - 1) % kParts;
    const Constants k = constants_;
    _Pragma("GCC unroll 8") for (size_t i = 0; i < kVectorsInPart; ++i) {
      TurnOf(k, kBefore, i);
      i < kLag ? FindRootOf(kBefore, i + kLag) : FindRootOf(P, i - kLag);
      AimOf(k, P, i);
    }
    ++flights_[kBefore];
  }

  HWY_INLINE void AimOf(const Constants& k, size_t part, size_t i) {
    Vector& v = vectors_[part * kVectorsInPart + i];
    const size_t from = flights_[part] % 2;
    Aim(k.flight, v.balls[from], v.balls[1 - from], v.flight);
  }

  HWY_INLINE void FindRootOf(size_t part, size_t i) {
    Vector& v = vectors_[part * kVectorsInPart + i];
    FindRoot(v.flight, v.balls[1 - flights_[part] % 2]);
  }

  // A flight can be looked at when it is done. Marked are the lanes whose ball is, or was before,
  // in the piston's reach, has left the cell, or has come a long way.
  HWY_INLINE void TurnOf(const Constants& k, size_t part, size_t i) {
    const D d;
    Vector& v = vectors_[part * kVectorsInPart + i];
    const size_t from = flights_[part] % 2, to = 1 - from;
    const V length = ballpiston::HWY_NAMESPACE::Turn(k.flight, v.flight, v.balls[to]);
    const V path = hn::Add(hn::Load(d, v.path[from]), length);
    hn::Store(path, d, v.path[to]);
    v.in_reach[to] = FindReach(k, v.balls[to]);
    const V left_cell = hn::Add(hn::Load(d, v.flight.q), hn::Set(d, kMissedByRounding));
    const V way_left = hn::Sub(hn::Set(d, kLongestPath), path);
    v.suspects = v.in_reach[0] | v.in_reach[1] | SignBits(d, hn::Or(left_cell, way_left));
  }

  // Where balls on walls are, relative to where the piston can be. In a frame that has the right
  // tip among the two tips of its arc (a < 0), the ball's depth in that tip is from_tip + b across.
  struct Depth {
    HWY_INLINE Depth(const Constants& k, const Balls<T>& balls) {
      const D d;
      const V h = hn::Load(d, balls.h), e = hn::Load(d, balls.e), c = hn::Load(d, balls.c),
              s = hn::Load(d, balls.s);
      across = hn::MulAdd(c, h, hn::Mul(s, e));
      from_tip = hn::MulAdd(c, e, hn::NegMulAdd(s, h, hn::Set(d, k.tip)));
    }
    V across, from_tip;
  };

  // Lanes whose ball may be in the piston's reach: it is, if the arc's right tip is the nearer one.
  static HWY_INLINE uint32_t FindReach(const Constants& k, const Balls<T>& balls) {
    const D d;
    const Depth depth(k, balls);
    const uint32_t outside = SignBits(d, hn::Add(depth.from_tip, hn::Abs(depth.across)));
    const uint32_t far_tip = (balls.b ^ SignBits(d, depth.across)) & k.one_tip;
    return balls.a & ~(outside | far_tip) & kAllLanes;
  }

  // In the lanes with a < 0.
  static HWY_INLINE V DepthOfAll(const Constants& k, const Balls<T>& balls) {
    const D d;
    const Depth depth(k, balls);
    const uint8_t bits[8] = {static_cast<uint8_t>(balls.b), static_cast<uint8_t>(balls.b >> 8)};
    const hn::Mask<D> negative = hn::LoadMaskBits(d, bits);
    const V across = hn::IfThenElse(negative, hn::Neg(depth.across), depth.across);
    return hn::Add(depth.from_tip, across);
  }

  // ---- what happened in the flights ----

  HWY_INLINE void LookAtPart(size_t part) {
    uint32_t suspects = 0;
    for (size_t i = 0; i < kVectorsInPart; ++i) {
      suspects |= vectors_[part * kVectorsInPart + i].suspects;
    }
    if (suspects != 0) LookAtSuspects(part);
  }

  // Not inlined, so that the loop of flights stays small.
  HWY_NOINLINE void LookAtSuspects(size_t part) {
    for (size_t i = 0; i < kVectorsInPart; ++i) {
      const size_t vector = part * kVectorsInPart + i;
      if (vectors_[vector].suspects != 0) LookAtVector(vector);
    }
    if (outside_.empty()) return;
    open_begin_ = parts_ == 1 ? 0 : part;
    open_end_ = parts_ == 1 ? kParts : part + 1;
    FlyOutside();
  }

  // The distance between ball and piston is a concave function of time, except where the piston
  // turns at its left wall. So they met if the ball ends beyond the piston, and may have met if the
  // piston turned while the ball was in its reach.
  HWY_INLINE void LookAtVector(size_t vector) {
    const D d;
    const Constants& k = constants_;
    Vector& v = vectors_[vector];
    const size_t to = After(vector * Width()), from = 1 - to;
    const V path = hn::Load(d, v.path[to]);
    const V before = PhaseAfter(v, hn::Load(d, v.path[from])), after = PhaseAfter(v, path);
    const V turns = hn::Floor(after);
    const V phase = hn::Sub(after, turns);
    const V way = hn::Min(phase, hn::Sub(hn::Set(d, T(1)), phase));
    const V piston = hn::Mul(way, hn::Set(d, k.period));
    const uint32_t beyond = Bits(d, hn::Gt(DepthOfAll(k, v.balls[to]), piston)) & v.in_reach[to];
    const uint32_t turned =
        Bits(d, hn::Gt(turns, hn::Floor(before))) & (v.in_reach[0] | v.in_reach[1]);
    const uint32_t left_cell =
        SignBits(d, hn::Add(hn::Load(d, v.flight.q), hn::Set(d, kMissedByRounding)));
    const uint32_t far = Bits(d, hn::Gt(path, hn::Set(d, kLongestPath)));
    v.suspects = 0;
    const size_t first = vector * Width();
    for (uint32_t lanes = left_cell & kAllLanes; lanes != 0; lanes &= lanes - 1) {
      Escape(first + hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
    }
    for (uint32_t lanes = (beyond | turned) & ~left_cell; lanes != 0; lanes &= lanes - 1) {
      const size_t lane = first + hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
      if (MeetOnTheWay(lane)) Leave(lane);
    }
    if (far != 0) TakePathsOut(vector, far);
  }

  static HWY_INLINE V PhaseAfter(const Vector& v, V path) {
    return hn::MulAdd(hn::Load(D(), v.ratio), path, hn::Load(D(), v.phase));
  }

  // In a lane that an orbit has just left it does no harm.
  void TakePathsOut(size_t vector, uint32_t lanes) {
    const D d;
    Vector& v = vectors_[vector];
    Column& path = v.path[After(vector * Width())];
    HWY_ALIGN Column phase;
    const V after = PhaseAfter(v, hn::Load(d, path));
    hn::Store(hn::Sub(after, hn::Floor(after)), d, phase);
    for (; lanes != 0; lanes &= lanes - 1) {
      const size_t i = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
      orbit_[vector * Width() + i].path += static_cast<double>(path[i]);
      path[i] = 0;
      v.phase[i] = phase[i];
    }
  }

  void Escape(size_t lane) {
    orbit_[lane].sums.escaped = true;
    EndInLane(lane);
  }

  // Of the piston after so much of the ball's path, in periods, below 1; the bits of PhaseAfter.
  double PhaseOf(size_t lane, T path) {
    const hn::CappedTag<T, 1> d;
    const Vector& v = VectorOf(lane);
    const auto phase = hn::MulAdd(hn::Set(d, v.ratio[InVector(lane)]), hn::Set(d, path),
                                  hn::Set(d, v.phase[InVector(lane)]));
    return static_cast<double>(hn::GetLane(hn::Sub(phase, hn::Floor(phase))));
  }

  // Of the ball, beyond the piston's left wall; scaled.
  double DepthOf(const Balls<T>& balls, size_t lane) const {
    const LaneFrame f = balls.Frame(InVector(lane));
    const double half = 0.5 * constants_.flight.scale * constants_.flight.scale;
    return f.a * (f.s * f.h - half - f.c * f.e) + f.b * (f.s * f.e + f.c * f.h) - constants_.left;
  }

  bool MeetOnTheWay(size_t lane) {
    const Vector& v = VectorOf(lane);
    const size_t i = InVector(lane), from = Before(lane), to = After(lane);
    const double x0 = DepthOf(v.balls[from], lane), x1 = DepthOf(v.balls[to], lane);
    const double phase0 = PhaseOf(lane, v.path[from][i]), phase1 = PhaseOf(lane, v.path[to][i]);
    if (x1 > std::min(phase1, 1 - phase1) * constants_.period) return true;
    const double length = static_cast<double>(v.path[to][i]) - v.path[from][i];
    const double way = v.ratio[i] * length;
    if (!(phase0 + way > 1 - kSlack)) return false;
    // The first and the last moment of the flight when the piston was at its left wall.
    const double first = std::clamp((1 - phase0) / way, 0.0, 1.0);
    const double last = std::clamp(1 - phase1 / way, 0.0, 1.0);
    return std::max(x0 + first * (x1 - x0), x0 + last * (x1 - x0)) > 0;
  }

  // Out of the lanes, at the beginning of the last flight.
  void Leave(size_t lane) {
    LaneOrbit& orbit = orbit_[lane];
    const Vector& v = VectorOf(lane);
    const size_t from = Before(lane);
    const T lane_path = v.path[from][InVector(lane)];
    const double phase = PhaseOf(lane, lane_path) * 2 * wave_.stroke();
    const double path = (orbit.path + static_cast<double>(lane_path)) / constants_.flight.scale;
    orbit.sums.time += path / orbit.ball_speed;
    orbit.sums.ball_wall_hits += flights_[PartOf(lane)] - 1 - orbit.entry_flight;
    orbit.sums.piston_wall_hits +=
        wave_.Hits(orbit.entry_phase, path * (orbit.piston_speed / orbit.ball_speed));
    const LaneFrame frame =
        Scaled(v.balls[from].Frame(InVector(lane)), 1 / constants_.flight.scale);
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
    idle_[PartOf(lane)].lanes.push_back(lane);
    --running_;
  }

  // ---- orbits outside of the lanes ----

  // Called while no part is in flight: advances slow orbits and starts new ones.
  void ResumeOutside() {
    open_begin_ = 0;
    open_end_ = kParts;
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
    slow_.insert(slow_.end(), outside_.begin(), outside_.end());
    outside_.clear();
    for (size_t part = open_begin_; part < open_end_; ++part) idle_[part].ParkNew(*this);
  }

  // Afterwards all orbits outside are in contact; `meetings_` has their contacts in the same order.
  void FlyToContacts() {
    meetings_.clear();
    size_t in_contact = 0;
    for (OrbitOutside& outside : outside_) {
      switch (FlyToContact(outside)) {
        case Flown::kToWall:
          Enter(outside);
          break;
        case Flown::kToContact:
          meetings_.push_back({outside.orbit.orbit, outside.orbit.sums});
          if (&outside_[in_contact] != &outside) outside_[in_contact] = outside;
          ++in_contact;
          break;
        case Flown::kNotFar:
          slow_.push_back(outside);
          break;
      }
    }
    outside_.erase(outside_.begin() + static_cast<std::ptrdiff_t>(in_contact), outside_.end());
  }

  enum class Flown { kToWall, kToContact, kNotFar };

  // The piston may turn many times before a slow ball reaches anything.
  Flown FlyToContact(OrbitOutside& outside) {
    Contact& sums = outside.orbit.sums;
    for (int events = 0; events < kMostEvents; ++events) {
      const Event event = outside.flow.Step();
      sums.Add(event);
      if (event.kind == EventKind::kBallWall) return Flown::kToWall;
      sums.expired = sums.time > limit_;
      if (event.kind == EventKind::kPistonWall && !sums.expired) continue;
      sums.state = outside.flow.state();
      return Flown::kToContact;
    }
    return Flown::kNotFar;
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
    size_t open = 0;
    for (size_t part = open_begin_; part < open_end_; ++part) open += idle_[part].lanes.size();
    const size_t room =
        std::min(open - outside_.size(), orbit_.size() - running_ - outside_.size() - slow_.size());
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

  // Into the first lane of those that are not in flight.
  void Enter(const OrbitOutside& outside) {
    size_t part = open_begin_;
    while (idle_[part].lanes.empty()) ++part;
    const size_t lane = idle_[part].Take();
    ++running_;
    if (part >= parts_) parts_ = kParts;
    orbit_[lane] = outside.orbit;
    Place(lane, outside.flow.state());
  }

  void Place(size_t lane, const PairState& state) {
    LaneOrbit& orbit = orbit_[lane];
    orbit.ball_speed = state.ball_speed;
    orbit.piston_speed = std::fabs(state.piston_velocity);
    orbit.path = 0;
    orbit.entry_phase = wave_.Phase(state);
    orbit.entry_flight = flights_[PartOf(lane)];
    const double scale = constants_.flight.scale, period = 2 * wave_.stroke();
    Vector& v = VectorOf(lane);
    const size_t i = InVector(lane), to = After(lane);
    v.balls[to].Set(i, Scaled(FrameOfBallOnWall(state.position, state.direction), scale));
    v.path[to][i] = 0;
    v.phase[i] = static_cast<T>(orbit.entry_phase / period);
    v.ratio[i] = static_cast<T>(orbit.piston_speed / orbit.ball_speed / (scale * period));
    const uint32_t bit = uint32_t{1} << i;
    const bool in_reach = DepthOf(v.balls[to], lane) >= 0;
    v.in_reach[to] = in_reach ? v.in_reach[to] | bit : v.in_reach[to] & ~bit;
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

  // Called while no part is in flight.
  void LookAtLimits() {
    for (size_t lane = 0; lane < parts_ * LanesInPart(); ++lane) {
      if (orbit_[lane].orbit != kNoOrbit && Elapsed(lane) > limit_) Expire(lane);
    }
  }

  double Elapsed(size_t lane) {
    const LaneOrbit& orbit = orbit_[lane];
    const T lane_path = VectorOf(lane).path[After(lane)][InVector(lane)];
    const double path = orbit.path + static_cast<double>(lane_path);
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

  // Brings the orbits that are left into the first part. Called while no part is in flight.
  void Compact() {
    if (parts_ == 1) return;
    parts_ = 1;
    size_t from = LanesInPart();
    for (size_t to = 0; to < LanesInPart(); ++to) {
      if (orbit_[to].orbit != kNoOrbit) continue;
      while (from < orbit_.size() && orbit_[from].orbit == kNoOrbit) ++from;
      if (from == orbit_.size()) break;
      Move(from, to);
    }
    ListIdleLanes();
  }

  // The parts need not have made as many flights: the first one flew alone before.
  void Move(size_t from, size_t to) {
    std::swap(orbit_[from], orbit_[to]);
    orbit_[to].entry_flight += flights_[PartOf(to)] - flights_[PartOf(from)];
    Vector& v = VectorOf(to);
    const Vector& w = VectorOf(from);
    const size_t i = InVector(to), j = InVector(from), now = After(to), then = After(from);
    v.balls[now].Set(i, w.balls[then].Frame(j));
    v.path[now][i] = w.path[then][j];
    v.phase[i] = w.phase[j];
    v.ratio[i] = w.ratio[j];
    const uint32_t bit = uint32_t{1} << i;
    const bool in_reach = (w.in_reach[then] >> j & 1) != 0;
    v.in_reach[now] = in_reach ? v.in_reach[now] | bit : v.in_reach[now] & ~bit;
    Park(from);
  }

  void ListIdleLanes() {
    for (size_t part = 0; part < kParts; ++part) {
      idle_[part].lanes.clear();
      for (size_t lane = (part + 1) * LanesInPart(); lane-- > part * LanesInPart();) {
        if (orbit_[lane].orbit == kNoOrbit) idle_[part].lanes.push_back(lane);
      }
      idle_[part].parked = idle_[part].lanes.size();
    }
  }

  // Lanes of a part without an orbit; the first `parked` of them are parked.
  struct IdleLanes {
    std::vector<size_t> lanes;
    size_t parked = 0;

    size_t Take() {
      const size_t lane = lanes.back();
      lanes.pop_back();
      parked = std::min(parked, lanes.size());
      return lane;
    }
    void ParkNew(LaneOrbits& orbits) {
      for (; parked < lanes.size(); ++parked) orbits.Park(lanes[parked]);
    }
  };

  static constexpr uint64_t kNoOrbit = ~uint64_t{0};

  PairGeometry geometry_;
  PistonWave wave_;
  Constants constants_;
  OrbitSource& source_;
  double limit_;  // time without a collision
  hwy::AlignedUniquePtr<Vector[]> vectors_;
  std::vector<LaneOrbit> orbit_;   // by lane
  size_t parts_ = kParts;          // that are flown: all, or the first
  uint64_t flights_[kParts] = {};  // done
  size_t running_ = 0;             // orbits in the lanes
  IdleLanes idle_[kParts];
  size_t open_begin_ = 0, open_end_ = kParts;  // parts that are not in flight: orbits may enter
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
