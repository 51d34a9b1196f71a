#include "core/billiard/orbits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/billiard/lane_orbits.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/billiard/exchange.h"
#include "core/billiard/lane_burst-inl.h"
#include "core/billiard/lane_constants.h"
#include "core/billiard/lane_orbit.h"
#include "core/billiard/lane_tangents-inl.h"
#include "core/closed_form/pair_measures.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The lanes fly in bursts of some flights each (lane_burst-inl.h). After a burst the engine
// examines the flights that began or ended in the piston's reach, reports the collisions that it
// finds to the source, and gives the lanes their next orbits. The flights need no branches. After a
// collision the ball may be anywhere in the cell (FrameOfBall); the lanes accept such a state.
//
// An orbit enters at the beginning of a burst, and every burst has the same number of flights. So
// the rounding at the end of a burst occurs at the same flights of the orbit in every lane.
//
// Fewer vectors would hardly take less time, so all vectors fly even if few lanes have orbits.

// The maximum numbers of bursts, and of calls of the source, between two calls of Pause. 512 bursts
// take about 0.2 ms. The source takes up to 5 us for a start or a collision, so 4096 of them take
// at most 0.02 s.
constexpr int kBurstsBetweenLooks = 512;
constexpr int64_t kCallsBetweenLooks = 4096;

// With kFollowsTangents the maps of the balls' flights are computed beside the flights.
template <typename T, bool kFollowsTangents>
class LaneOrbits : public EngineRun {
 public:
  LaneOrbits(const PairGeometry& geometry, OrbitSource& source)
      : geometry_(geometry),
        flight_constants_(geometry),
        reach_constants_(geometry, flight_constants_.scale),
        source_(source),
        in_lane_(geometry, flight_constants_.scale, source.TimeLimit()),
        least_mean_flight_(sizeof(T) == 4 && std::isinf(source.TimeLimit())
                               ? MeanFlight(geometry) * flight_constants_.scale / 10
                               : 0),
        flights_(FlightsInABurst(geometry)),
        steps_(flights_ * kVectors),
        pistons_(kVectors),
        orbit_(Width() * kVectors),
        entry_burst_(orbit_.size()) {
    for (size_t lane = orbit_.size(); lane-- > 0;) idle_.push_back(lane);
  }

  bool Advance() override {
    do {
      source_is_empty_ = false;
      calls_left_ = kCallsBetweenLooks;
      Refill();
      for (int i = 0; i < kBurstsBetweenLooks && calls_left_ > 0 && IsRunning(); ++i) Burst();
      LookAtLimits();
      if (source_is_empty_ && !IsRunning()) return true;
    } while (!source_.Pause());
    return false;
  }

 private:
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;

  static size_t Width() { return hn::Lanes(D()); }

  // Beside a vector of balls, as they are between two bursts.
  struct Pistons : PistonWaves<T> {
    HWY_ALIGN double path[kMostLanes<T>];  // the ball's since the orbit entered
    uint32_t lanes;                        // that have orbits
  };

  struct Entry {
    size_t lane;
    OrbitStart start;
  };

  size_t VectorOf(size_t lane) const { return lane / Width(); }
  size_t InVector(size_t lane) const { return lane % Width(); }
  bool IsRunning() const { return idle_.size() < orbit_.size(); }

  // ---- a burst ----

  void Burst() {
    Fly();
    LookAtFlights();
    EndBurst();
    if (!entries_.empty() || parked_ < idle_.size()) Refill();
  }

  // Only the arcs at the right tip can be in the piston's reach. The ball is on such an arc if a <
  // 0; b tells on which side of the arc the tip is.
  void Fly() {
    const auto reach = [edge = reach_constants_.edge](const Balls<T>& balls) HWY_ATTR {
      const TipsInReach tips = TipsOf(balls, edge);
      return balls.a & (tips.below ^ (balls.ab & (tips.below ^ tips.above)));
    };
    burst_.Fly(flight_constants_, flights_, reach);
    ++bursts_;
  }

  // Makes the last slots the start of the next burst. Paths begin at 0 again, because sums of short
  // paths have little rounding.
  void EndBurst() {
    if constexpr (kFollowsTangents) tangents_.FollowBurst(burst_, flights_);
    const D d;
    for (size_t v = 0; v < kVectors; ++v) {
      Pistons& piston = pistons_[v];
      const V path = hn::Load(d, burst_.slot(steps_ + v).path);
      const V phase = piston.PhaseAfter(path);
      hn::Store(hn::Sub(phase, hn::Floor(phase)), d, piston.phase);
      AddPath(path, piston.path);
      Copy(burst_.slot(steps_ + v), burst_.slot(v));
      hn::Store(hn::Zero(d), d, burst_.slot(v).path);
      burst_.in_reach(v) = burst_.in_reach(steps_ + v);
    }
  }

  static HWY_INLINE void Copy(const Balls<T>& from, Balls<T>& to) {
    const D d;
    hn::Store(hn::Load(d, from.h), d, to.h);
    hn::Store(hn::Load(d, from.e), d, to.e);
    hn::Store(hn::Load(d, from.c), d, to.c);
    hn::Store(hn::Load(d, from.s), d, to.s);
    to.a = from.a;
    to.ab = from.ab;
    to.m = from.m;
  }

  static HWY_INLINE void AddPath(V path, double* sums) {
    const hn::ScalableTag<double> d;
    if constexpr (sizeof(T) == 8) {
      hn::Store(hn::Add(hn::Load(d, sums), path), d, sums);
    } else {
#if HWY_TARGET == HWY_SCALAR
      sums[0] += static_cast<double>(hn::GetLane(path));
#else
      const hn::Half<D> half;
      const auto low = hn::PromoteTo(d, hn::LowerHalf(half, path));
      const auto high = hn::PromoteTo(d, hn::UpperHalf(half, path));
      hn::Store(hn::Add(hn::Load(d, sums), low), d, sums);
      sums += hn::Lanes(d);
      hn::Store(hn::Add(hn::Load(d, sums), high), d, sums);
#endif
    }
  }

  // ---- events of a burst ----

  void LookAtFlights() {
    if (HWY_UNLIKELY(burst_.left_cell())) {
      burst_.ListAll();
    } else {
      burst_.ListFlightsInReach();
    }
    if (flights_ == kMostFlights) burst_.Keep([this](size_t t) { return PistonMayBeNear(t); });
    burst_.Keep([this](size_t t) { return LanesThatMayHaveMet(t); });
    for (const auto& [t, lanes] : burst_.listed()) {
      if (HWY_UNLIKELY(burst_.left_cell())) LookForEscapes(t);
      LookForCollisions(t, lanes & pistons_[t % kVectors].lanes);
    }
  }

  // A cheaper test before MayHaveMet: the piston turned at its left wall, or began or ended so near
  // to it that it may have touched a ball in the tip.
  HWY_INLINE uint32_t PistonMayBeNear(size_t t) const {
    const D d;
    const Pistons& piston = pistons_[t % kVectors];
    const V before = piston.PhaseAfter(hn::Load(d, burst_.slot(t).path));
    const V after = piston.PhaseAfter(hn::Load(d, burst_.slot(t + kVectors).path));
    const V turns = hn::Floor(after), last = hn::Floor(before);
    const V nearest =
        hn::Min(hn::Sub(before, last), hn::Sub(hn::Add(turns, hn::Set(d, T(1))), after));
    const uint32_t turned = Bits(d, hn::Gt(turns, last));
    const uint32_t near = Bits(d, hn::Lt(nearest, hn::Set(d, reach_constants_.phase_at_tip)));
    return (turned | near) & burst_.InReachAround(t) & piston.lanes;
  }

  HWY_INLINE uint32_t LanesThatMayHaveMet(size_t t) const {
    const D d;
    const Balls<T>&from = burst_.slot(t), &to = burst_.slot(t + kVectors);
    const Pistons& piston = pistons_[t % kVectors];
    const T half_height = flight_constants_.half_height;
    return MayHaveMet(reach_constants_, PlacesInCell(from, half_height).X(),
                      PlacesInCell(to, half_height).X(), piston.PhaseAfter(hn::Load(d, from.path)),
                      piston.PhaseAfter(hn::Load(d, to.path))) &
           burst_.InReachAround(t) & piston.lanes;
  }

  HWY_NOINLINE void LookForEscapes(size_t t) {
    const D d;
    const V c = hn::Load(d, burst_.slot(t + kVectors).c);
    const V square = hn::NegMulAdd(c, c, hn::Set(d, T(2)));
    const V left_cell = hn::Add(square, hn::Set(d, kMissedByRounding<T>));
    ForLanes(t, SignBits(d, left_cell) & pistons_[t % kVectors].lanes,
             [&](size_t lane) { Report(lane, OrbitInLane::Escape()); });
  }

  void LookForCollisions(size_t t, uint32_t lanes) {
    ForLanes(t, lanes, [&](size_t lane) {
      const std::optional<Collision> collision = FindCollision(t, lane);
      if (collision) Report(lane, *collision);
    });
  }

  template <typename Function>
  static HWY_INLINE void ForLanes(size_t t, uint32_t lanes, const Function& function) {
    const size_t first = t % kVectors * Width();
    for (; lanes != 0; lanes &= lanes - 1) {
      function(first + hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
    }
  }

  // The orbit leaves the lane. If it goes on, it enters again before the next burst.
  void Report(size_t lane, const Collision& collision) {
    pistons_[VectorOf(lane)].lanes &= ~(uint32_t{1} << InVector(lane));
    --calls_left_;
    const uint64_t orbit = orbit_[lane].orbit;
    const AfterCollision after = source_.Collide(orbit, collision);
    if (after == AfterCollision::kEnd || collision.escaped || collision.expired) {
      idle_.push_back(lane);
    } else {
      entries_.push_back({lane, {orbit, AfterExchange(collision.state, 1.0)}});
    }
  }

  // The collision of ball and piston of the lane in flight t, if they meet.
  std::optional<Collision> FindCollision(size_t t, size_t lane) const {
    const size_t i = InVector(lane);
    const Pistons& piston = pistons_[VectorOf(lane)];
    const Balls<T>& from = burst_.slot(t);
    std::optional<OrbitInLane::Meeting> met = in_lane_.Meet(
        orbit_[lane],
        {.ball = from.Frame(i),
         .phase = PhaseOf(piston, i, from.path[i]),
         .path = piston.path[i] + static_cast<double>(from.path[i]),
         .length = static_cast<double>(burst_.slot(t + kVectors).path[i] - from.path[i]),
         .flights = (bursts_ - 1 - entry_burst_[lane]) * flights_ + t / kVectors});
    if (!met) return std::nullopt;
    if constexpr (kFollowsTangents) {
      met->collision.flights = tangents_.MapTo(burst_, t, i, met->way, flight_constants_.scale);
    }
    return met->collision;
  }

  // The piston's phase when the ball has gone `path` in this burst, in periods, at least 0 and
  // below 1.
  // It has the same bits as PhaseAfter of the whole vector.
  static double PhaseOf(const Pistons& piston, size_t i, T path) {
    const hn::CappedTag<T, 1> d;
    const auto phase =
        hn::MulAdd(hn::Set(d, piston.ratio[i]), hn::Set(d, path), hn::Set(d, piston.phase[i]));
    return static_cast<double>(hn::GetLane(hn::Sub(phase, hn::Floor(phase))));
  }

  // ---- between bursts ----

  // Gives the lanes their next orbits. A ball at rest collides, or is lost, at once. After
  // kCallsBetweenLooks calls of the source the next Refill starts the remaining orbits.
  void Refill() {
    while (!entries_.empty() || StartNew()) {
      const auto [lane, start] = entries_.back();
      entries_.pop_back();
      Enter(lane, start);
      const std::optional<Collision> met = in_lane_.MeetAtRest(orbit_[lane], start.state);
      if (met) Report(lane, *met);
    }
    for (; parked_ < idle_.size(); ++parked_) Park(idle_[parked_]);
  }

  // Takes an orbit for an idle lane. An orbit that starts outside of the cell escapes at once.
  bool StartNew() {
    while (calls_left_ > 0 && !source_is_empty_ && !idle_.empty()) {
      const std::optional<OrbitStart> start = source_.Next();
      source_is_empty_ = !start;
      if (!start) return false;
      --calls_left_;
      if (InsideCell(geometry_, start->state.position, kOnAWallAtStart)) {
        entries_.push_back({idle_.back(), *start});
        idle_.pop_back();
        parked_ = std::min(parked_, idle_.size());
        return true;
      }
      --calls_left_;
      source_.Collide(start->orbit, OrbitInLane::Escape());
    }
    return false;
  }

  void Enter(size_t lane, const OrbitStart& start) {
    const size_t v = VectorOf(lane), i = InVector(lane);
    orbit_[lane] = in_lane_.Orbit(start);
    entry_burst_[lane] = bursts_;
    const LaneEntry entry = in_lane_.Enter(orbit_[lane], start.state, kSlack<T>);
    Balls<T>& balls = burst_.slot(v);
    balls.Set(i, entry.ball);
    balls.path[i] = 0;
    const uint32_t bit = uint32_t{1} << i;
    uint16_t& lanes = burst_.in_reach(v);
    lanes = static_cast<uint16_t>(entry.in_reach ? lanes | bit : lanes & ~bit);
    Pistons& piston = pistons_[v];
    piston.phase[i] = static_cast<T>(entry.phase);
    piston.ratio[i] = static_cast<T>(entry.ratio);
    piston.path[i] = 0;
    piston.lanes |= bit;
    if constexpr (kFollowsTangents) tangents_.Restart(v, i);
  }

  // A lane without an orbit flies between two discs.
  void Park(size_t lane) {
    Enter(lane, {.state = {.position = {0, 0},
                           .direction = {-M_SQRT1_2, -M_SQRT1_2},
                           .ball_speed = 1,
                           .piston = geometry_.piston_right()}});
    pistons_[VectorOf(lane)].lanes &= ~(uint32_t{1} << InVector(lane));
  }

  void LookAtLimits() {
    for (size_t lane = 0; lane < orbit_.size(); ++lane) {
      const Pistons& piston = pistons_[VectorOf(lane)];
      if ((piston.lanes >> InVector(lane) & 1) == 0) continue;
      const double path = std::max(piston.path[InVector(lane)], LeastPath(lane));
      const double time = in_lane_.TimeOf(orbit_[lane], path);
      if (time > orbit_[lane].longest_wait) Report(lane, in_lane_.Overdue(time));
    }
    Refill();
  }

  // Single precision may trap a ball in a tip, where it hits the walls without end and its path
  // hardly grows. So that its orbit ends too, a flight counts as a tenth of the mean flight at
  // least. The longest wait has thousands of flights, and over so many the mean flight of an orbit
  // that is not trapped is longer than that.
  double LeastPath(size_t lane) const {
    return least_mean_flight_ * static_cast<double>((bursts_ - entry_burst_[lane]) * flights_);
  }

  PairGeometry geometry_;
  FlightConstants<T> flight_constants_;
  ReachConstants<T> reach_constants_;
  OrbitSource& source_;
  OrbitInLane in_lane_;
  // 0 in double precision, and if orbits have a time limit, which may end after a few flights.
  double least_mean_flight_;
  size_t flights_, steps_;  // of a lane, and of a vector, in a burst
  LaneBurst<T> burst_;
  std::vector<Pistons> pistons_;
  uint64_t bursts_ = 0;
  std::vector<LaneOrbit> orbit_;       // by lane
  std::vector<uint64_t> entry_burst_;  // by lane
  std::vector<size_t> idle_;           // lanes without an orbit
  size_t parked_ = 0;                  // of them, the first ones
  std::vector<Entry> entries_;         // orbits that enter a lane before the next burst
  bool source_is_empty_ = false;       // at the last call of Next
  int64_t calls_left_ = 0;             // starts and collisions until the next call of Pause
  std::conditional_t<kFollowsTangents, LaneTangents<T>, std::monostate> tangents_;
};

template <typename T>
std::unique_ptr<EngineRun> Start(const PairGeometry& geometry, OrbitSource& source) {
  if (source.FollowsTangents()) return std::make_unique<LaneOrbits<T, true>>(geometry, source);
  return std::make_unique<LaneOrbits<T, false>>(geometry, source);
}

std::unique_ptr<EngineRun> StartDouble(const PairGeometry& geometry, OrbitSource& source) {
  return Start<double>(geometry, source);
}

std::unique_ptr<EngineRun> StartSingle(const PairGeometry& geometry, OrbitSource& source) {
  return Start<float>(geometry, source);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(StartDouble);
HWY_EXPORT(StartSingle);

std::unique_ptr<EngineRun> StartLaneOrbits(const PairGeometry& geometry, OrbitSource& source) {
  return HWY_DYNAMIC_DISPATCH(StartDouble)(geometry, source);
}

std::unique_ptr<EngineRun> StartLaneOrbitsSingle(const PairGeometry& geometry,
                                                 OrbitSource& source) {
  return HWY_DYNAMIC_DISPATCH(StartSingle)(geometry, source);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
