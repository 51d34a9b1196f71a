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
#include "core/billiard/lane_frame.h"
#include "core/billiard/piston_wave.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {

static_assert(kMostFlightsAhead == kMostFlights);
static_assert(kMostBallsAhead >= kVectors * kMostLanes<double> || HWY_TARGET == HWY_SCALAR);
static_assert(kReachSlack == kSlack<double>);

class FlightsAhead {
 public:
  FlightsAhead(const GasInTime& gas, size_t flights, std::span<FlightOrder> orders)
      : gas_(gas),
        is_lattice_(gas.geometry.shape().is_lattice),
        flights_(flights),
        orders_(orders),
        vectors_(orders.size() <= Width() ? 1 : kVectors),
        constants_(gas.geometry.pair()) {}

  static size_t Width() { return hn::Lanes(hn::ScalableTag<double>()); }
  static size_t Count() { return kVectors * Width(); }

  void Fly(std::span<const FlyingBall> from, std::span<FlyingBall> to) {
    for (size_t i = 0; i < vectors_ * Width(); ++i) {
      Load(i, from[orders_[std::min(i, orders_.size() - 1)].ball]);
    }
    const bool left_cell = FlyVectors();
    for (size_t i = 0; i < orders_.size(); ++i) Store(i, left_cell, to[orders_[i].ball]);
    FindMeetings();
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
    if (is_lattice_) {
      return FlyWatched([edge = gas_.edge](const Balls<double>& balls) HWY_ATTR {
        const TipsInReach tips = TipsOf(balls, edge);
        return tips.above | tips.below;
      });
    }
    // The cell's right is along x of the frame if a and b are equal.
    return FlyWatched([edge = gas_.edge](const Balls<double>& balls) HWY_ATTR {
      const TipsInReach tips = TipsOf(balls, edge);
      return tips.below ^ (balls.ab & (tips.below ^ tips.above));
    });
  }

  template <class Reach>
  bool FlyWatched(const Reach& reach) {
    if (vectors_ == 1) return FlyOneVector(constants_, flights_, reach, slots_, in_reach_);
    return FlyBurst(constants_, flights_, reach, slots_, in_reach_);
  }

  // In the order of each ball's path.
  void FindMeetings() const {
    for (size_t t = 0; t < flights_ * vectors_; ++t) {
      const size_t first = t % vectors_ * Width();
      uint32_t lanes = in_reach_[t] | in_reach_[t + vectors_];
      for (; lanes != 0; lanes &= lanes - 1) {
        const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
        if (first + lane >= orders_.size()) break;
        FlightOrder& order = orders_[first + lane];
        if (order.first || slots_[t].path[lane] > order.until) continue;
        LookForPistons(lane, slots_[t], slots_[t + vectors_], order);
      }
    }
  }

  HWY_INLINE void LookForPistons(size_t lane, const Balls<double>& from, const Balls<double>& to,
                                 FlightOrder& order) const {
    const double unit = gas_.unit;
    const BallInTime& ball = gas_.balls[order.ball];
    const double path = from.path[lane] * unit, length = to.path[lane] * unit - path;
    const double start = ball.since + path * ball.slowness;
    if (start + length * ball.slowness < order.from_time) return;
    const double h = from.h[lane] * unit, e = from.e[lane] * unit;
    const double c = from.c[lane] * unit, s = from.s[lane] * unit;
    const double ux = h + e, uy = h - e;
    const double x = s * ux + c * uy - 0.5, y = s * uy - c * ux - 0.5;
    const auto look = [&](double place, double velocity, uint32_t toward) HWY_ATTR {
      if (std::max(place, place + velocity * length) < gas_.wave.left() - kReachSlack) return;
      Compare(place, velocity, length, start, toward, lane, from, order);
    };
    const bool is_turned = (from.ab >> lane & 1) != 0;  // the cell's right is along y of the frame
    if (is_lattice_ || !is_turned) {
      look(x, ux, 0);
      look(-x, -ux, 2);
    }
    if (is_lattice_ || is_turned) {
      look(y, uy, 1);
      look(-y, -uy, 3);
    }
  }

  // Whether ball and piston meet in a flight from `place` on, toward one of the frame's axes.
  // Events before the piston's last change are done already, so the result does not depend on the
  // time of the call.
  HWY_INLINE void Compare(double place, double velocity, double length, double start,
                          uint32_t toward, size_t lane, const Balls<double>& from,
                          FlightOrder& order) const {
    const PistonWave& wave = gas_.wave;
    const BallInTime& ball = gas_.balls[order.ball];
    const Direction direction = DirectionOf(from, lane, toward);
    const PistonInTime& piston = gas_.pistons[ball.pistons[static_cast<size_t>(direction)]];
    const double begin = std::max(start, piston.since), gone = (begin - start) * ball.speed;
    const double phase = piston.PhaseAt(begin, direction, wave);
    const double ratio = piston.speed * ball.slowness;
    const double x = place + velocity * gone - wave.left();
    if (!wave.MayMeet(phase, ratio, x, velocity, length - gone, kReachSlack)) return;
    const auto meeting = wave.FirstMeeting(phase, ratio, x, velocity, length - gone);
    if (!meeting) return;
    const double time = begin + meeting->way * ball.slowness;
    if (time > order.until_time || (order.first && order.first->time <= time)) return;
    order.first = MeetingAt(lane, from, gone + meeting->way, direction);
    order.first->time = time;
    order.first->piston_goes_right = meeting->piston_goes_right;
  }

  MeetingInTime MeetingAt(size_t lane, const Balls<double>& from, double way,
                          Direction direction) const {
    const LaneFrame frame = Scaled(from.Frame(lane), gas_.unit);
    Eigen::Vector2d velocity = DirectionInCell(frame);
    velocity *= OneOverLength(velocity);
    return {.position = PositionInCell(frame) + velocity * way,
            .velocity = velocity,
            .direction = direction};
  }

  // The direction in the cell of one of the frame's axes, by quarter turns from its x axis. The
  // cell's right is x of the frame, by a quarter turn on if ab is set, and opposite if a is set.
  static Direction DirectionOf(const Balls<double>& balls, size_t lane, uint32_t toward) {
    const auto bit = [lane](uint32_t bits) { return bits >> lane & 1; };
    const uint32_t right = bit(balls.ab) + 2 * bit(balls.a);
    const uint32_t turns = toward - right;
    return static_cast<Direction>((bit(balls.m) != 0 ? 0 - turns : turns) & 3);
  }

  bool HasEscaped(size_t i) const {
    for (size_t t = i / Width() + vectors_; t < (flights_ + 1) * vectors_; t += vectors_) {
      const double c = slots_[t].c[i % Width()];
      if (2 - c * c < -kMissedByRounding<double>) return true;
    }
    return false;
  }

  const GasInTime& gas_;
  bool is_lattice_;
  size_t flights_;
  std::span<FlightOrder> orders_;
  size_t vectors_;
  FlightConstants<double> constants_;
  Balls<double> slots_[kMostSteps + kVectors];
  uint16_t in_reach_[kMostSteps + kVectors];
};

void FlyAheadInLanes(const GasInTime& gas, size_t flights, std::span<FlightOrder> orders,
                     std::span<const FlyingBall> from, std::span<FlyingBall> to) {
  for (size_t first = 0; first < orders.size(); first += FlightsAhead::Count()) {
    const size_t count = std::min(FlightsAhead::Count(), orders.size() - first);
    FlightsAhead(gas, flights, orders.subspan(first, count)).Fly(from, to);
  }
}

double EdgeInLanes(const PairGeometry& pair, double unit) {
  return EdgeOfReach<double>(pair, 1 / unit);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(EdgeInLanes);
HWY_EXPORT(FlyAheadInLanes);

GasInTime::GasInTime(const GasGeometry& g)
    : geometry(g),
      wave(g.pair()),
      walls(g.pair()),
      unit(g.pair().rho() / M_SQRT2),
      edge(HWY_DYNAMIC_DISPATCH(EdgeInLanes)(g.pair(), unit)) {}

namespace {

// In a tip a ball may be on both walls, or beyond them by rounding. Reflects the ball until it
// flies away from both walls. Returns true if the ball was reflected.
bool ReflectOnWalls(const CellWalls<double>& walls, Eigen::Vector2d& position,
                    Eigen::Vector2d& direction) {
  // The paths between a few hits in a tip add up to less than this, which is far below kReachSlack.
  constexpr double kOnAWall = 1e-14;
  constexpr int kMostHits = 10'000;  // many hits if the walls are nearly parallel
  int last_disc = kNoDisc;
  double way = 0;
  for (int i = 0; i < kMostHits; ++i) {
    const CellWalls<double>::Encounter hit = walls.Next(position, direction, last_disc);
    way += hit.distance;
    if (way > kOnAWall) break;
    walls.Reflect(hit, position, direction);
    last_disc = hit.disc;
  }
  return last_disc != kNoDisc;
}

}  // namespace

FlyingBall PlacedBall(const GasInTime& gas, Eigen::Vector2d position, Eigen::Vector2d direction) {
  const double left = gas.wave.left() - kReachSlack;
  const bool is_on_wall = ReflectOnWalls(gas.walls, position, direction);
  const auto frame_of = is_on_wall ? FrameOfBallOnWall : FrameOfBall;
  const LaneFrame frame = Scaled(frame_of(position, direction), 1 / gas.unit);
  return {.h = frame.h,
          .e = frame.e,
          .c = frame.c,
          .s = frame.s,
          .path = 0,
          .a = frame.a < 0,
          .ab = frame.a != frame.b,
          .m = frame.m < 0,
          .is_in_reach = std::fabs(position.x()) >= left ||
                         (gas.geometry.shape().is_lattice && std::fabs(position.y()) >= left),
          .has_escaped = false};
}

void FlyAhead(const GasInTime& gas, size_t flights, std::span<FlightOrder> orders,
              std::span<const FlyingBall> from, std::span<FlyingBall> to) {
  HWY_DYNAMIC_DISPATCH(FlyAheadInLanes)(gas, flights, orders, from, to);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
