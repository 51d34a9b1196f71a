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
#include "core/closed_form/pair_measures.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {

static_assert(kReachSlack == kSlack<double>);

class LanesAhead : public FlightsAhead {
 public:
  explicit LanesAhead(GasInTime& gas)
      : gas_(gas),
        directions_(gas.geometry.directions()),
        mean_flight_(MeanFlight(gas.geometry.pair()) / gas.unit),
        flight_constants_(gas.geometry.pair()),
        reach_constants_(gas.geometry.pair(), flight_constants_.scale) {}

  void Fly(std::span<FlightOrder> orders) override {
    const size_t count = kVectors * Width();
    for (size_t first = 0; first < orders.size(); first += count) {
      orders_ = orders.subspan(first, std::min(count, orders.size() - first));
      FlyTogether();
    }
  }

 private:
  using D = hn::ScalableTag<double>;

  // Up to this number of vectors, FlyFew takes less time than a full burst, which also computes the
  // empty vectors.
  static constexpr size_t kMostOfFew = 3;

  static constexpr uint32_t kEveryDirection = 0x01010101;  // the first bit of each

  static size_t Width() { return hn::Lanes(D()); }

  void FlyTogether() {
    vectors_ = (orders_.size() + Width() - 1) / Width();
    if (vectors_ > kMostOfFew) vectors_ = kVectors;
    for (size_t i = 0; i < vectors_ * Width(); ++i) {
      const FlightOrder& order = orders_[std::min(i, orders_.size() - 1)];
      const BallInTime& ball = gas_.balls[order.ball];
      until_[i] = (order.until_time - ball.since) * ball.speed / gas_.unit;
      Load(i, ball.to);
      LoadPistons(i, ball);
    }
    flights_ = FlightsOfMost();
    std::fill_n(end_, orders_.size(), flights_);
    FlyVectors();
    if (HWY_UNLIKELY(burst_.left_cell())) FindLostBalls();
    std::fill_n(visitors_, vectors_, 0);
    FindCollisions();
    CountFlights();
    for (size_t i = 0; i < orders_.size(); ++i) Finish(i);
  }

  // The flights that most of the balls need; the others fly on later.
  size_t FlightsOfMost() const {
    double path = 0;
    for (size_t i = 0; i < orders_.size(); ++i) {
      path += until_[i] - burst_.slot(i / Width()).path[i % Width()];
    }
    const double mean = path / mean_flight_ / static_cast<double>(orders_.size());
    return static_cast<size_t>(std::min(1.25 * mean + 2, double{kMostFlights}));
  }

  void Load(size_t i, const FlyingBall& ball) {
    const size_t slot = i / Width(), lane = i % Width();
    Balls<double>& vector = burst_.slot(slot);
    uint16_t& in_reach = burst_.in_reach(slot);
    if (lane == 0) in_reach = 0;
    vector.Set(lane, ball.frame);
    vector.path[lane] = ball.path;
    in_reach = static_cast<uint16_t>(in_reach | uint32_t{ball.is_in_reach} << lane);
  }

  // A piston's wave is continued to times before its last change, which may add false alarms.
  void LoadPistons(size_t i, const BallInTime& ball) {
    const size_t lane = i % Width();
    const double per_period = 1 / (2 * gas_.wave.stroke());
    for (int j = 0; j < directions_; ++j) {
      const Direction direction = gas_.geometry.DirectionAt(j);
      const PistonInTime& piston = PistonOf(ball, direction);
      PistonWaves<double>& waves = pistons_[i / Width()][static_cast<size_t>(direction)];
      const double half_turn = SignOf(direction) < 0 ? 0.5 : 0;
      waves.phase[lane] =
          half_turn + per_period * (piston.phase + piston.speed * (ball.since - piston.since));
      waves.ratio[lane] = per_period * piston.speed * ball.slowness * gas_.unit;
    }
  }

  const PistonInTime& PistonOf(const BallInTime& ball, Direction direction) const {
    return gas_.pistons[ball.pistons[static_cast<size_t>(direction)]];
  }

  void FlyVectors() {
    if (directions_ == 4) {
      FlyWatched([edge = reach_constants_.edge](const Balls<double>& balls) HWY_ATTR {
        const TipsInReach tips = TipsOf(balls, edge);
        return tips.above | tips.below;
      });
    } else {
      // The cell's right is along x of the frame if a and b are equal.
      FlyWatched([edge = reach_constants_.edge](const Balls<double>& balls) HWY_ATTR {
        const TipsInReach tips = TipsOf(balls, edge);
        return tips.below ^ (balls.ab & (tips.below ^ tips.above));
      });
    }
  }

  template <class Reach>
  void FlyWatched(const Reach& reach) {
    if (vectors_ == kVectors) {
      burst_.Fly(flight_constants_, flights_, reach);
    } else {
      burst_.FlyFew(flight_constants_, vectors_, flights_, reach);
    }
  }

  // A lost ball's flights end with the one in which it misses all discs.
  HWY_NOINLINE void FindLostBalls() {
    for (size_t i = 0; i < orders_.size(); ++i) {
      for (size_t flight = flights_; flight-- > 0;) {
        const double c = burst_.slot(SlotOf(i, flight + 1)).c[i % Width()];
        if (2 - c * c < -kMissedByRounding<double>) end_[i] = flight;
      }
    }
  }

  // Before the flight.
  static size_t SlotOf(size_t i, size_t flight) { return i / Width() + flight * kVectors; }

  // In the order of each ball's path.
  void FindCollisions() {
    burst_.ListFlightsInReach();
    burst_.Keep([this](size_t t) HWY_ATTR { return MayHaveMetPistons(t); });
    for (const auto& [t, lanes] : burst_.listed()) {
      for (uint32_t left = lanes; left != 0; left &= left - 1) {
        const size_t bit = hwy::Num0BitsBelowLS1Bit_Nonzero32(left);
        const size_t i = t % kVectors * Width() + bit % kBitsOfADirection;
        if (i >= orders_.size() || t / kVectors >= end_[i]) continue;
        LookForCollision(t, i, static_cast<Direction>(bit / kBitsOfADirection));
      }
    }
  }

  // The lanes whose balls may have met their pistons, eight bits for each direction. Adds those
  // whose balls could have met any piston there.
  HWY_INLINE uint32_t MayHaveMetPistons(size_t t) {
    const D d;
    const Balls<double>&from = burst_.slot(t), &to = burst_.slot(t + kVectors);
    const PlacesInCell before(from, flight_constants_.half_height);
    const PlacesInCell after(to, flight_constants_.half_height);
    const auto path0 = hn::Load(d, from.path), path1 = hn::Load(d, to.path);
    const PistonWaves<double>* const pistons = pistons_[t % kVectors];
    uint32_t visitors = 0;
    const auto met = [&](Direction direction, auto x0, auto x1) HWY_ATTR {
      const auto i = static_cast<size_t>(direction);
      visitors |= Bits(d, hn::Gt(hn::Max(x0, x1), hn::Set(d, reach_constants_.left)))
                  << i * kBitsOfADirection;
      return MayHaveMet(reach_constants_, x0, x1, pistons[i].PhaseAfter(path0),
                        pistons[i].PhaseAfter(path1))
             << i * kBitsOfADirection;
    };
    const auto x0 = before.X(), x1 = after.X();
    uint32_t lanes =
        met(Direction::kRight, x0, x1) | met(Direction::kLeft, hn::Neg(x0), hn::Neg(x1));
    if (directions_ == 4) {
      const auto y0 = before.Y(), y1 = after.Y();
      lanes |= met(Direction::kUp, y0, y1) | met(Direction::kDown, hn::Neg(y0), hn::Neg(y1));
    }
    visitors_[t % kVectors] |= visitors;
    return lanes & burst_.InReachAround(t) * kEveryDirection;
  }

  // Whether ball and piston meet in flight t. Events before the piston's last change are done
  // already, so the result does not depend on the time of the call.
  void LookForCollision(size_t t, size_t i, Direction direction) {
    const FlightOrder& order = orders_[i];
    const Balls<double>& from = burst_.slot(t);
    const size_t lane = i % Width();
    if (from.path[lane] > until_[i]) return;
    BallInTime& ball = gas_.balls[order.ball];
    const double path = from.path[lane] * gas_.unit;
    const double length = burst_.slot(t + kVectors).path[lane] * gas_.unit - path;
    const double start = ball.since + path * ball.slowness;
    if (start + length * ball.slowness < order.from_time) return;
    const PistonWave& wave = gas_.wave;
    const PistonInTime& piston = PistonOf(ball, direction);
    const double begin = std::max(start, piston.since), gone = (begin - start) * ball.speed;
    const double phase = piston.PhaseAt(begin, direction, wave);
    const double ratio = piston.speed * ball.slowness;
    const LaneFrame frame = Scaled(from.Frame(lane), gas_.unit);
    const double velocity = SeenToward(direction, DirectionInCell(frame)).x();
    const double place = SeenToward(direction, PositionInCell(frame)).x();
    const double x = place + velocity * gone - wave.left();
    const auto collision = wave.FirstCollision(phase, ratio, x, velocity, length - gone);
    if (!collision) return;
    const double time = begin + collision->way * ball.slowness;
    if (time > order.until_time || ball.collision.time <= time) return;
    end_[i] = t / kVectors + 1;
    const BallPlace before = PlaceOf(gas_, from.Frame(lane));
    ball.collision = {.position = before.position + before.direction * (gone + collision->way),
                      .velocity = before.direction,
                      .time = time,
                      .direction = direction,
                      .piston_goes_right = collision->piston_goes_right};
  }

  // Finds each ball's last flight that begins before the ball may stop. Paths only grow, so its
  // number is that of the later flights that begin by then.
  void CountFlights() {
    const D d;
    for (size_t vector = 0; vector < vectors_; ++vector) {
      const auto until = hn::Load(d, until_ + vector * Width());
      auto begun = hn::Zero(d);
      for (size_t flight = 1; flight <= flights_; ++flight) {
        const auto path = hn::Load(d, burst_.slot(vector + flight * kVectors).path);
        begun = hn::Add(begun, hn::IfThenElseZero(hn::Le(path, until), hn::Set(d, 1)));
      }
      hn::Store(begun, d, begun_ + vector * Width());
    }
  }

  // The ball's state before the flight in which it arrives. A ball that meets a piston does not fly
  // on: the exchange changes its way.
  void Finish(size_t i) const {
    const size_t lane = i % Width();
    FlightOrder& order = orders_[i];
    BallInTime& ball = gas_.balls[order.ball];
    ball.visits |= visitors_[i / Width()] >> lane & kEveryDirection;
    order.has_arrived = ball.collision.time < kNever;
    if (order.has_arrived) return;
    const auto begun = static_cast<size_t>(begun_[i]);
    const bool is_beyond = begun < end_[i];
    order.has_escaped = end_[i] < flights_ && !is_beyond;
    order.has_arrived = order.has_escaped || is_beyond;
    const size_t slot = SlotOf(i, std::min(begun, end_[i]));
    ball.to = {.frame = burst_.slot(slot).Frame(lane),
               .path = burst_.slot(slot).path[lane],
               .is_in_reach = (burst_.in_reach(slot) >> lane & 1) != 0};
  }

  GasInTime& gas_;
  int directions_;
  double mean_flight_;  // in the lanes' unit
  FlightConstants<double> flight_constants_;
  ReachConstants<double> reach_constants_;
  size_t flights_ = 0;
  std::span<FlightOrder> orders_;
  size_t vectors_ = 0;
  LaneBurst<double> burst_;
  PistonWaves<double> pistons_[kVectors][4];  // by direction
  uint32_t visitors_[kVectors];  // lanes whose balls came within reach, as in MayHaveMetPistons
  // By order: the path length at which the ball may stop, the last flight that begins before it,
  // and the number of flights in which the ball may still meet a piston for the first time.
  HWY_ALIGN double until_[kVectors * kMostLanes<double>];
  HWY_ALIGN double begun_[kVectors * kMostLanes<double>];
  size_t end_[kVectors * kMostLanes<double>];
};

std::unique_ptr<FlightsAhead> NewLanes(GasInTime& gas) { return std::make_unique<LanesAhead>(gas); }

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(NewLanes);

GasInTime::GasInTime(const GasGeometry& g)
    : geometry(g), wave(g.pair()), walls(g.pair()), unit(g.pair().rho() / M_SQRT2) {}

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
  return {.frame = Scaled(frame_of(position, direction), 1 / gas.unit),
          .path = 0,
          .is_in_reach = std::fabs(position.x()) >= left ||
                         (gas.geometry.shape().is_lattice && std::fabs(position.y()) >= left)};
}

BallPlace PlaceOf(const GasInTime& gas, const LaneFrame& frame) {
  const LaneFrame in_cells = Scaled(frame, gas.unit);
  Eigen::Vector2d direction = DirectionInCell(in_cells);
  direction *= OneOverLength(direction);
  return {PositionInCell(in_cells), direction};
}

std::unique_ptr<FlightsAhead> LanesOf(GasInTime& gas) {
  return HWY_DYNAMIC_DISPATCH(NewLanes)(gas);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
