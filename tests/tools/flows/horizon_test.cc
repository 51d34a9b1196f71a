// How long orbits agree with the exact orbit: both engines, in double and in single precision,
// compared with the flow in 113 bits.
//
// The billiard is chaotic: on the median orbit a difference grows by the same factor per hit, about
// 2.5. Consider an engine with an error of about one rounding unit in each flight, and an exact
// flow whose start is off by one unit. The engine parts from the exact orbit no later than this
// flow, and not much earlier: errors of up to 8 units per flight (single_flight_test.cc), summed as
// a geometric series with this factor, equal about 13 units at the start, or log 13/log 2.5 = 3
// hits.
#include "core/billiard/lane_frame.h"
#include "core/billiard/reference_flow.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"

namespace ballpiston {
namespace {

constexpr double kParted = 1e-3;  // in cells
constexpr size_t kOrbits = 301;
constexpr size_t kHits = 48;
constexpr double kDoubleUnit = 0x1p-53, kSingleUnit = 0x1p-24;

using Places = std::vector<Eigen::Vector2d>;  // the ball's positions at its hits

std::vector<PairState> StartsOnWall(const PairGeometry& geometry) {
  std::vector<PairState> starts;
  for (size_t i = 0; i < kOrbits; ++i) {
    CounterRandom random(31, 0, i);
    PairState start = DrawFromFlowMeasure(geometry, random);
    start.ball_speed = 1;
    start.piston = geometry.piston_right();
    start.piston_velocity = 0;
    ReferenceFlow flow(geometry, start);
    flow.Step();
    starts.push_back(flow.state());
  }
  return starts;
}

template <typename Real>
Places Flown(const PairGeometry& geometry, const PairStateOf<Real>& start) {
  EventFlow<Real> flow(geometry, start);
  Places places;
  for (size_t hit = 0; hit < kHits; ++hit) {
    EXPECT_EQ(flow.Step().kind, EventKind::kBallWall);
    places.push_back(RoundedTo<double>(flow.state()).position);
  }
  return places;
}

// The exact orbit from a neighbouring start: its direction is turned by an angle.
Places FlownBeside(const PairGeometry& geometry, const PairState& start, double angle) {
  auto beside = RoundedTo<Quadruple>(start);
  const auto direction = beside.direction;
  beside.direction.x() -= angle * direction.y();
  beside.direction.y() += angle * direction.x();
  return Flown(geometry, beside);
}

template <typename Fly>
Places FlownInLanes(const PairGeometry& geometry, const PairState& start, Fly fly) {
  const LaneFrame frame = FrameOfBallOnWall(start.position, start.direction);
  std::vector<LaneHit> hits(kHits);
  fly(geometry, {&frame, 1}, kHits, hits);
  Places places;
  for (const LaneHit& hit : hits) places.push_back(PositionInCell(hit.frame));
  return places;
}

struct Column {
  std::string name;
  std::function<Places(const PairState&)> orbit;
  std::vector<double> distances = {};  // of the median orbit, hit by hit
  size_t horizon = 0;                  // hits until the distance is kParted
};

std::vector<Column> Columns(const PairGeometry& geometry) {
  const auto beside = [&geometry](double unit) {
    return [&geometry, unit](const PairState& s) { return FlownBeside(geometry, s, unit); };
  };
  return {{"reference", [&](const PairState& s) { return Flown(geometry, s); }},
          {"lanes", [&](const PairState& s) { return FlownInLanes(geometry, s, FlyLaneBalls); }},
          {"exact, 2^-53", beside(kDoubleUnit)},
          {"lanes single",
           [&](const PairState& s) { return FlownInLanes(geometry, s, FlyLaneBallsSingle); }},
          {"exact, 2^-24", beside(kSingleUnit)}};
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void Measure(const std::vector<PairState>& starts, const std::vector<Places>& exact,
             Column& column) {
  std::vector<std::vector<double>> distances(kHits);
  for (size_t i = 0; i < starts.size(); ++i) {
    const Places places = column.orbit(starts[i]);
    for (size_t hit = 0; hit < kHits; ++hit) {
      distances[hit].push_back((places[hit] - exact[i][hit]).norm());
    }
  }
  for (const auto& of_orbits : distances) column.distances.push_back(Median(of_orbits));
  column.horizon =
      static_cast<size_t>(std::find_if(column.distances.begin(), column.distances.end(),
                                       [](double d) { return d > kParted; }) -
                          column.distances.begin());
}

void Print(double rho, const std::vector<Column>& columns) {
  std::cout << "median distance from the orbit in 113 bits, rho = " << std::setprecision(6) << rho
            << "\nhits";
  for (const Column& column : columns) std::cout << std::setw(14) << column.name;
  for (size_t hit = 0; hit < kHits; hit += 3) {
    std::cout << "\n" << std::setw(4) << hit + 1;
    for (const Column& column : columns) {
      std::cout << std::setw(14) << std::setprecision(2) << column.distances[hit];
    }
  }
  std::cout << "\n1e-3";
  for (const Column& column : columns) std::cout << std::setw(14) << column.horizon;
  std::cout << "\n";
}

class Horizon : public testing::TestWithParam<double> {};

TEST_P(Horizon, MatchesAnExactOrbitWhoseStartIsOffByOneRoundingUnit) {
  const double rho = GetParam();
  const PairGeometry geometry = GeometryAtShare(rho, 0.1);
  const std::vector<PairState> starts = StartsOnWall(geometry);
  std::vector<Places> exact;
  for (const PairState& start : starts) {
    exact.push_back(Flown(geometry, RoundedTo<Quadruple>(start)));
  }
  std::vector<Column> columns = Columns(geometry);
  for (Column& column : columns) {
    Measure(starts, exact, column);
    ASSERT_LT(column.horizon, kHits);
  }
  Print(rho, columns);
  for (const auto& [engine, beside] : {std::pair{0u, 2u}, {1u, 2u}, {3u, 4u}}) {
    EXPECT_GE(columns[engine].horizon + 3, columns[beside].horizon) << columns[engine].name;
    EXPECT_LE(columns[engine].horizon, columns[beside].horizon + 1) << columns[engine].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Rho, Horizon, testing::Values(0.501, 0.51, kPaperRho, 0.6));

}  // namespace
}  // namespace ballpiston
