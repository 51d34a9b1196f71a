// Compares a flight in lanes with a flight of the reference, and both with a flight of 64 bits or
// more, from half a million states: anywhere in the cell, where arcs meet, and where rays touch
// arcs.
//
// The bound. Let u be the rounding of a number next to 1, 2^-53 or in single precision 2^-24. The
// error of the ray's impact parameter c' on the next disc is some u: c' is the cross product of the
// direction with the ball's and with the disc's position, each a sum of a few rounded terms below
// 1; rho^2 is also rounded. The flight ends at the foot minus s', s'^2 = rho^2 - c'^2, so
//     |error of the time| <= u (A + B/cos phi),   cos phi = s'/rho,
// unless cos phi is as small as its error, sqrt(2 B u), which is then the error of the root.
// An engine may choose another arc than the exact ray only in two cases:
//   tie    the exact ray reaches both arcs, at times that differ by at most the two bounds;
//   touch  the exact ray touches one of the two arcs within B u, as a hit or as a miss.
#include "core/billiard/event_flow.h"
#include "core/billiard/lane_frame.h"
#include "tests/core/billiard/each_target.h"
#include "tests/core/preamble.h"
#include "tests/oracle/exact_flight.h"
#include "tools/flows/lane_balls.h"

namespace ballpiston {
namespace {

using Eigen::Vector2d;
using ExactFlight = oracle::ExactFlight<long double>;

constexpr double kDouble = 0x1p-53, kSingle = 0x1p-24;  // u
constexpr double kTimeUnits = 8;                        // A
constexpr double kImpactUnits = 8;                      // B

// The smallest half width of a cell in which single precision resolves a position.
constexpr double kSmallestInSingle = 1e-4;

constexpr size_t kStatesOfAGeometry = 50'000;
constexpr int kFlightsOfAStart = 4;

double TimeBound(double unit, long double cosine) {
  const double smallest = std::sqrt(2 * kImpactUnits * unit);
  return unit * (kTimeUnits + kImpactUnits / std::max(static_cast<double>(cosine), smallest));
}

// From vanishing tips to a vanishing cell.
std::vector<PairGeometry> GeometriesOfFlights() {
  std::vector<PairGeometry> geometries;
  for (const double rho :
       {0.5 + 1e-12, 0.5 + 1e-6, 0.501, 0.51, kPaperRho, 0.56, 0.6, 0.65, 0.7, 0.70710678}) {
    geometries.push_back(GeometryAtShare(rho, 0.1));
  }
  return geometries;
}

double RandomOffset(CounterRandom& random) {
  const double sign = random.Bits() % 2 == 0 ? 1 : -1;
  return sign * std::pow(10, -3 - static_cast<double>(random.Bits() % 15));
}

Vector2d Perpendicular(const Vector2d& a) { return {-a.y(), a.x()}; }

// Balls alone that are about to leave a wall. All starts are drawn for the disc at the lower left,
// then mirrored to the other discs.
class Starts {
 public:
  Starts(const PairGeometry& geometry, uint64_t stream)
      : geometry_(geometry), tip_angle_(std::acos(0.5 / geometry.rho())), random_(5, stream, 0) {}

  PairState Next() {
    for (;;) {
      const Vector2d position = Centre() + geometry_.rho() * Normal();
      const Vector2d direction = Direction(position).normalized();
      if (direction.dot(position - Centre()) <= 0 || position.maxCoeff() >= 0) continue;
      const Vector2d mirror = {random_.Bits() % 2 == 0 ? 1 : -1, random_.Bits() % 2 == 0 ? 1 : -1};
      return {.position = position.cwiseProduct(mirror),
              .direction = direction.cwiseProduct(mirror),
              .ball_speed = 1,
              .piston = geometry_.piston_right()};
    }
  }

 private:
  static Vector2d Centre() { return {-0.5, -0.5}; }

  // Anywhere on the arc, or next to one of its tips.
  Vector2d Normal() {
    double angle = tip_angle_ + (M_PI_2 - 2 * tip_angle_) * random_.Uniform();
    if (random_.Bits() % 4 == 0) angle = tip_angle_ + std::fabs(RandomOffset(random_));
    return {std::cos(angle), std::sin(angle)};
  }

  // Anywhere, at a tip, or touching a disc.
  Vector2d Direction(const Vector2d& position) {
    switch (random_.Bits() % 4) {
      case 0: {
        const double angle = 2 * M_PI * random_.Uniform();
        return {std::cos(angle), std::sin(angle)};
      }
      case 1:
        return AtTip(position);
      default:
        return Touching(position);
    }
  }

  Vector2d AtTip(const Vector2d& position) {
    const double t = geometry_.tip();
    const Vector2d tips[] = {{t, 0}, {0, t}, {-t, 0}, {0, -t}};
    const Vector2d way = tips[random_.Bits() % 4] - position;
    return way + RandomOffset(random_) * Perpendicular(way);
  }

  Vector2d Touching(const Vector2d& position) {
    const Vector2d way = oracle::DiscCentre(1 + static_cast<int>(random_.Bits() % 3)) - position;
    const double sine = std::min(geometry_.rho() * (1 + RandomOffset(random_)) / way.norm(), 1.0);
    const double side = random_.Bits() % 2 == 0 ? 1 : -1;
    return way * std::sqrt((1 - sine) * (1 + sine)) + side * sine * Perpendicular(way);
  }

  PairGeometry geometry_;
  double tip_angle_;  // of the tips, from the axes
  CounterRandom random_;
};

struct ReferenceFlight {
  PairState before, after;
  int from;  // the disc on which it begins
  double time;
  int to;
};

// The disc that has just reflected the ball. Next to a tip the position alone does not determine
// the disc, so the change of direction is used, which is along the arc's normal.
int ReflectedBy(const PairGeometry& geometry, const PairState& before, const PairState& after) {
  const Vector2d change = after.direction - before.direction;
  const auto misfit = [&](int disc) {
    const Vector2d normal = (after.position - oracle::DiscCentre(disc)) / geometry.rho();
    return std::fabs(normal.norm() - 1) + (change - change.norm() * normal).norm();
  };
  int best = 0;
  for (int disc = 1; disc < 4; ++disc) {
    if (misfit(disc) < misfit(best)) best = disc;
  }
  return best;
}

std::vector<ReferenceFlight> ReferenceFlights(const PairGeometry& geometry, uint64_t stream) {
  std::vector<ReferenceFlight> flights;
  Starts starts(geometry, stream);
  while (flights.size() < kStatesOfAGeometry) {
    const PairState start = starts.Next();
    ReferenceFlow flow(geometry, start);
    int from = oracle::DiscOfQuadrant(start.position);
    for (int i = 0; i < kFlightsOfAStart; ++i) {
      const PairState before = flow.state();
      const Event event = flow.Step();
      EXPECT_EQ(event.kind, EventKind::kBallWall);
      const int to = ReflectedBy(geometry, before, flow.state());
      flights.push_back({before, flow.state(), from, event.duration, to});
      from = to;
    }
  }
  return flights;
}

// The number of the frame's disc. Its centre is (-1/2, -1/2) from the cell's centre in the frame.
int DiscOf(const LaneFrame& frame) {
  return (frame.a < 0 ? 1 : 0) | (frame.m * frame.b < 0 ? 2 : 0);
}

struct Tally {
  size_t states = 0, ties = 0, touches = 0, wrong = 0;
  std::string a_wrong_one = {};
  double worst_time = 0;       // of the engine against the exact flight, in bounds
  double worst_impact = 0;     // in units
  double worst_place = 0;      // of the two engines' balls, in the sum of their bounds
  double worst_direction = 0;  // likewise
};

// Whether the exact ray takes `disc` as well as its own, within rounding.
void JudgeArc(double unit, const ExactFlight& exact, double rho, int disc, Tally& tally) {
  const auto &taken = exact.Of(disc), &right = exact.First();
  const auto touched = [unit, rho](const ExactFlight::Disc& d) {
    return std::fabs(std::fabs(d.impact) - rho) <= kImpactUnits * unit;
  };
  if (std::fabs(taken.length - right.length) <=
      TimeBound(unit, taken.cosine) + TimeBound(unit, right.cosine)) {
    ++tally.ties;
  } else if (touched(taken) || touched(right)) {
    ++tally.touches;
  } else {
    ++tally.wrong;
    tally.a_wrong_one = absl::StrCat("arc ", disc, " instead of ", exact.first);
  }
}

void Judge(double unit, const ExactFlight& exact, double rho, int disc, double time, Tally& tally) {
  ++tally.states;
  if (disc != exact.first) return JudgeArc(unit, exact, rho, disc, tally);
  const auto error = static_cast<double>(std::fabs(time - exact.First().length));
  tally.worst_time = std::max(tally.worst_time, error / TimeBound(unit, exact.First().cosine));
}

ExactFlight ExactOf(const PairGeometry& geometry, const ReferenceFlight& flight) {
  return {geometry, flight.before.position, flight.before.direction, flight.from};
}

// The error of the ball's position along the ray is that of the time. The direction turns by twice
// the angle to the normal; the error of this angle is that of the position over rho > 1/2.
void CompareEngines(double bounds, const ReferenceFlight& reference, const LaneHit& lane,
                    Tally& tally) {
  const Vector2d place = PositionInCell(lane.frame), direction = DirectionInCell(lane.frame);
  const auto worsen = [bounds](double& worst, double difference) {
    worst = std::max(worst, std::fabs(difference) / bounds);
  };
  worsen(tally.worst_place, (place - reference.after.position).norm());
  worsen(tally.worst_place, lane.x - reference.after.position.x());
  worsen(tally.worst_direction, (direction - reference.after.direction).norm() / 4);
}

void JudgeLanes(double unit, const PairGeometry& geometry,
                const std::vector<ReferenceFlight>& flights, Tally& tally) {
  std::vector<LaneFrame> starts;
  for (const ReferenceFlight& flight : flights) {
    starts.push_back(FrameOfBallOnWall(flight.before.position, flight.before.direction));
  }
  std::vector<LaneHit> hits(starts.size());
  (unit == kDouble ? FlyLaneBalls : FlyLaneBallsSingle)(geometry, starts, 1, hits);
  for (size_t i = 0; i < flights.size(); ++i) {
    const ReferenceFlight& flight = flights[i];
    const ExactFlight exact = ExactOf(geometry, flight);
    const int disc = DiscOf(hits[i].frame);
    Judge(unit, exact, geometry.rho(), disc, hits[i].length, tally);
    if (disc == exact.first) {
      const long double impact = std::fabs(exact.First().impact);
      tally.worst_impact =
          std::max(tally.worst_impact,
                   static_cast<double>(std::fabs(std::fabs(hits[i].frame.c) - impact)) / unit);
    }
    if (disc == flight.to) {
      CompareEngines(2 * TimeBound(unit, exact.Of(disc).cosine), flight, hits[i], tally);
    }
  }
}

TEST(SingleFlight, LanesMatchTheReferenceInPlaceAndTime) {
  const std::vector<PairGeometry> geometries = GeometriesOfFlights();
  std::vector<std::vector<ReferenceFlight>> flights;
  Tally reference;
  for (const PairGeometry& geometry : geometries) {
    flights.push_back(ReferenceFlights(geometry, flights.size()));
    for (const ReferenceFlight& flight : flights.back()) {
      Judge(kDouble, ExactOf(geometry, flight), geometry.rho(), flight.to, flight.time, reference);
    }
  }
  EXPECT_GE(reference.states, 500'000u);
  EXPECT_GE(reference.ties + reference.touches, 1000u);  // the starts are as degenerate as meant
  EXPECT_EQ(reference.wrong, 0u) << reference.a_wrong_one;
  EXPECT_LE(reference.worst_time, 1);
  ForEachTarget([&](int64_t) {
    for (const double unit : {kDouble, kSingle}) {
      SCOPED_TRACE(unit == kDouble ? "double" : "single");
      Tally lanes;
      for (size_t i = 0; i < flights.size(); ++i) {
        if (geometries[i].tip() < kSmallestInSingle && unit == kSingle) continue;
        JudgeLanes(unit, geometries[i], flights[i], lanes);
      }
      EXPECT_EQ(lanes.wrong, 0u) << lanes.a_wrong_one;
      EXPECT_LE(lanes.worst_time, 1);
      EXPECT_LE(lanes.worst_impact, kImpactUnits);
      EXPECT_LE(lanes.worst_place, 1);
      EXPECT_LE(lanes.worst_direction, 1);
    }
  });
}

}  // namespace
}  // namespace ballpiston
