#include "core/gas/lane_visits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/gas/lane_visits.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "core/billiard/exchange.h"
#include "core/billiard/lane_burst-inl.h"
#include "core/billiard/piston_wave.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {

static_assert(kMostFlightsAhead == kMostFlights);
static_assert(kMostBallsAhead >= kVectors * kMostLanes<double> || HWY_TARGET == HWY_SCALAR);
static_assert(kReachSlack == kSlack<double>);

class FlightsAhead {
 public:
  FlightsAhead(const GasGeometry& geometry, const GasInTime& gas, size_t flights,
               std::span<FlightOrder> orders)
      : geometry_(geometry),
        gas_(gas),
        wave_(geometry.pair()),
        left_(wave_.left() - kReachSlack),
        unit_(FlyingUnit(geometry)),
        flights_(flights),
        orders_(orders),
        vectors_(orders.size() <= Width() ? 1 : kVectors),
        constants_(geometry.pair()) {}

  static size_t Width() { return hn::Lanes(hn::ScalableTag<double>()); }
  static size_t Count() { return kVectors * Width(); }

  void Fly(std::span<const FlyingBall> from, std::span<FlyingBall> to, std::vector<Visit>& visits) {
    for (size_t i = 0; i < vectors_ * Width(); ++i) {
      Load(i, from[orders_[std::min(i, orders_.size() - 1)].ball]);
    }
    const bool left_cell = FlyVectors();
    for (size_t i = 0; i < orders_.size(); ++i) Store(i, left_cell, to[orders_[i].ball]);
    Record(visits);
  }

 private:
  void Load(size_t i, const FlyingBall& ball) {
    const size_t slot = i / Width(), lane = i % Width();
    Balls<double>& vector = slots_[slot];
    if (lane == 0) vector.a = vector.ab = vector.m = in_reach_[slot] = 0;
    vector.h[lane] = ball.h;
    vector.e[lane] = ball.e;
    vector.c[lane] = ball.c;
    vector.s[lane] = ball.s;
    vector.path[lane] = ball.path;
    vector.a |= uint32_t{ball.a} << lane;
    vector.ab |= uint32_t{ball.ab} << lane;
    vector.m |= uint32_t{ball.m} << lane;
    in_reach_[slot] = static_cast<uint16_t>(in_reach_[slot] | uint32_t{ball.is_in_reach} << lane);
  }

  void Store(size_t i, bool left_cell, FlyingBall& ball) {
    const size_t lane = i % Width();
    FlightOrder& order = orders_[i];
    size_t slot = i / Width() + flights_ * vectors_;
    order.has_arrived = slots_[slot].path[lane] > order.until;
    while (slot >= vectors_ && slots_[slot].path[lane] > order.until) slot -= vectors_;
    const Balls<double>& vector = slots_[slot];
    const auto bit = [lane](uint32_t bits) { return (bits >> lane & 1) != 0; };
    ball = {.h = vector.h[lane],
            .e = vector.e[lane],
            .c = vector.c[lane],
            .s = vector.s[lane],
            .path = vector.path[lane],
            .a = bit(vector.a),
            .ab = bit(vector.ab),
            .m = bit(vector.m),
            .is_in_reach = bit(in_reach_[slot]),
            .has_escaped = left_cell && HasEscaped(i)};
  }

  bool FlyVectors() {
    if (geometry_.shape().is_lattice) {
      return FlyWatched([edge = Edge()](const Balls<double>& balls) HWY_ATTR {
        const TipsInReach tips = TipsOf(balls, edge);
        return tips.above | tips.below;
      });
    }
    // The cell's right is along x of the frame where a and b are equal.
    return FlyWatched([edge = Edge()](const Balls<double>& balls) HWY_ATTR {
      const TipsInReach tips = TipsOf(balls, edge);
      return tips.below ^ (balls.ab & (tips.below ^ tips.above));
    });
  }

  double Edge() const { return EdgeOfReach<double>(geometry_.pair(), constants_.scale); }

  template <class Reach>
  bool FlyWatched(const Reach& reach) {
    if (vectors_ == 1) return FlyOneVector(constants_, flights_, reach, slots_, in_reach_);
    return FlyBurst(constants_, flights_, reach, slots_, in_reach_);
  }

  // Of the flights that began by `until`.
  void Record(std::vector<Visit>& visits) const {
    for (size_t t = 0; t < flights_ * vectors_; ++t) {
      const size_t first = t % vectors_ * Width();
      uint32_t lanes = in_reach_[t] | in_reach_[t + vectors_];
      for (; lanes != 0; lanes &= lanes - 1) {
        const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
        if (first + lane >= orders_.size()) break;
        const FlightOrder& order = orders_[first + lane];
        if (slots_[t].path[lane] > order.until) continue;
        LookForPistons(order.ball, lane, slots_[t], slots_[t + vectors_], visits);
      }
    }
  }

  // Cheap, because of hundred flights that come here one meets a piston.
  HWY_INLINE void LookForPistons(uint32_t number, size_t lane, const Balls<double>& from,
                                 const Balls<double>& to, std::vector<Visit>& visits) const {
    const double h = from.h[lane] * unit_, e = from.e[lane] * unit_;
    const double c = from.c[lane] * unit_, s = from.s[lane] * unit_;
    const double ux = h + e, uy = h - e;
    const double x = s * ux + c * uy - 0.5, y = s * uy - c * ux - 0.5;
    const double path = from.path[lane] * unit_;
    const double length = to.path[lane] * unit_ - path;
    const BallInTime& ball = gas_.balls[number];
    const auto look = [&](double place, double velocity, uint32_t toward) HWY_ATTR {
      if (std::max(place, place + velocity * length) < left_) return;
      const Direction direction = DirectionOf(from, lane, toward);
      const PistonInTime& piston = gas_.pistons[ball.pistons[static_cast<size_t>(direction)]];
      const double start = ball.since + path * ball.slowness;
      const double begin = std::max(start, piston.since), gone = (begin - start) * ball.speed;
      const double phase = piston.PhaseAt(begin, direction, wave_);
      if (!wave_.MayMeet(phase, piston.speed * ball.slowness,
                         place + velocity * gone - wave_.left(), velocity, length - gone,
                         kReachSlack)) {
        return;
      }
      RecordFlight(number, lane, from, length, direction, visits);
    };
    const bool is_lattice = geometry_.shape().is_lattice;
    const bool is_turned = (from.ab >> lane & 1) != 0;  // the cell's right is along y of the frame
    if (is_lattice || !is_turned) {
      look(x, ux, 0);
      look(-x, -ux, 2);
    }
    if (is_lattice || is_turned) {
      look(y, uy, 1);
      look(-y, -uy, 3);
    }
  }

  // The direction in the cell of one of the frame's axes, by quarter turns from its x axis. The
  // cell's right is x of the frame, by a quarter turn on if ab is set, and opposite if a is set.
  static Direction DirectionOf(const Balls<double>& balls, size_t lane, uint32_t toward) {
    const auto bit = [lane](uint32_t bits) { return bits >> lane & 1; };
    const uint32_t right = bit(balls.ab) + 2 * bit(balls.a);
    const uint32_t turns = toward - right;
    return static_cast<Direction>((bit(balls.m) != 0 ? 0 - turns : turns) & 3);
  }

  void RecordFlight(uint32_t ball, size_t lane, const Balls<double>& from, double length,
                    Direction direction, std::vector<Visit>& visits) const {
    const LaneFrame frame = Scaled(from.Frame(lane), unit_);
    Eigen::Vector2d velocity = DirectionInCell(frame);
    velocity *= OneOverLength(velocity);
    visits.push_back({.path = from.path[lane] * unit_,
                      .length = length,
                      .position = PositionInCell(frame),
                      .velocity = velocity,
                      .ball = ball,
                      .piston = direction});
  }

  bool HasEscaped(size_t i) const {
    for (size_t t = i / Width() + vectors_; t < (flights_ + 1) * vectors_; t += vectors_) {
      const double c = slots_[t].c[i % Width()];
      if (2 - c * c < -kMissedByRounding<double>) return true;
    }
    return false;
  }

  const GasGeometry& geometry_;
  const GasInTime& gas_;
  PistonWave wave_;
  double left_;
  double unit_;
  size_t flights_;
  std::span<FlightOrder> orders_;
  size_t vectors_;
  FlightConstants<double> constants_;
  Balls<double> slots_[kMostSteps + kVectors];
  uint16_t in_reach_[kMostSteps + kVectors];
};

void FlyAheadInLanes(const GasGeometry& geometry, const GasInTime& gas, size_t flights,
                     std::span<FlightOrder> orders, std::span<const FlyingBall> from,
                     std::span<FlyingBall> to, std::vector<Visit>& visits) {
  for (size_t first = 0; first < orders.size(); first += FlightsAhead::Count()) {
    const size_t count = std::min(FlightsAhead::Count(), orders.size() - first);
    FlightsAhead(geometry, gas, flights, orders.subspan(first, count)).Fly(from, to, visits);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(FlyAheadInLanes);

double FlyingUnit(const GasGeometry& geometry) { return geometry.pair().rho() / M_SQRT2; }

FlyingBall PlacedBall(const GasGeometry& geometry, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& direction) {
  const double left = geometry.pair().piston_left() - kReachSlack;
  const LaneFrame frame = Scaled(FrameOfBall(position, direction), 1 / FlyingUnit(geometry));
  return {.h = frame.h,
          .e = frame.e,
          .c = frame.c,
          .s = frame.s,
          .path = 0,
          .a = frame.a < 0,
          .ab = frame.a != frame.b,
          .m = frame.m < 0,
          .is_in_reach = std::fabs(position.x()) >= left ||
                         (geometry.shape().is_lattice && std::fabs(position.y()) >= left),
          .has_escaped = false};
}

void FlyAhead(const GasGeometry& geometry, const GasInTime& gas, size_t flights,
              std::span<FlightOrder> orders, std::span<const FlyingBall> from,
              std::span<FlyingBall> to, std::vector<Visit>& visits) {
  HWY_DYNAMIC_DISPATCH(FlyAheadInLanes)(geometry, gas, flights, orders, from, to, visits);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
