// If collisions are too rare to sample, the lanes and the reference are compared by the joint law
// of the ball after a thousand wall hits. The piston needs no comparison, because its position is a
// function of time only.
#include "core/billiard/reference_flow.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tests/oracle/two_sample.h"
#include "tools/flows/lane_balls.h"

namespace ballpiston {
namespace {

constexpr size_t kBalls = 10'000;
constexpr uint64_t kHits = 1000;

// Just after a wall hit.
struct BallOnWall {
  Eigen::Vector2d position;
  Eigen::Vector2d direction;
  double last_flight = 0;
};

BallOnWall AfterHits(ReferenceFlow& flow, uint64_t hits) {
  double length = 0;
  while (hits > 0) {
    const Event event = flow.Step();
    EXPECT_EQ(event.kind, EventKind::kBallWall);
    length = event.duration;
    --hits;
  }
  return {flow.state().position, flow.state().direction, length};
}

// The ball has speed 1; the piston rests out of the ball's reach.
ReferenceFlow BallAlone(const PairGeometry& geometry, uint64_t seed, uint64_t sample) {
  CounterRandom random(seed, 31, sample);
  PairState state = DrawFromFlowMeasure(geometry, random);
  state.ball_speed = 1;
  state.piston = geometry.piston_right();
  state.piston_velocity = 0;
  return ReferenceFlow(geometry, state);
}

std::vector<BallOnWall> ByReference(const PairGeometry& geometry) {
  std::vector<BallOnWall> balls;
  for (uint64_t i = 0; i < kBalls; ++i) {
    ReferenceFlow flow = BallAlone(geometry, 1, i);
    balls.push_back(AfterHits(flow, kHits + 1));
  }
  return balls;
}

std::vector<BallOnWall> ByLanes(const PairGeometry& geometry) {
  std::vector<LaneFrame> starts;
  for (uint64_t i = 0; i < kBalls; ++i) {
    ReferenceFlow flow = BallAlone(geometry, 2, i);
    const BallOnWall first = AfterHits(flow, 1);
    starts.push_back(FrameOfBallOnWall(first.position, first.direction));
  }
  std::vector<LaneHit> hits(kBalls);
  FlyLaneBalls(geometry, starts, kHits, hits);
  std::vector<BallOnWall> balls;
  for (const LaneHit& hit : hits) {
    balls.push_back({PositionInCell(hit.frame), DirectionInCell(hit.frame), hit.length});
  }
  return balls;
}

// Angles: of the place around the cell's middle, and of the direction.
std::array<double, 2> Angles(const BallOnWall& ball) {
  return {std::atan2(ball.position.y(), ball.position.x()),
          std::atan2(ball.direction.y(), ball.direction.x())};
}

std::vector<uint64_t> JointCounts(const std::vector<BallOnWall>& balls) {
  constexpr size_t kCells = 12;
  std::vector<uint64_t> counts(kCells * kCells);
  const auto cell = [](double angle) {
    const auto i = static_cast<size_t>((angle / (2 * M_PI) + 0.5) * kCells);
    return std::min(i, kCells - 1);
  };
  for (const BallOnWall& ball : balls) {
    const auto [place, direction] = Angles(ball);
    ++counts[cell(place) * kCells + cell(direction)];
  }
  return counts;
}

template <typename Of>
std::vector<double> Values(const std::vector<BallOnWall>& balls, Of of) {
  std::vector<double> values;
  for (const BallOnWall& ball : balls) values.push_back(of(ball));
  return values;
}

class LongFlights : public testing::TestWithParam<double> {};

// The joint law of place and direction by chi^2 (3e-5), that of the last flight's length and of the
// place alone by Kolmogorov and Smirnov (5e-5 each): over five radii 7e-4 false alarms.
TEST_P(LongFlights, AgreeInLawAfterAThousandHits) {
  const PairGeometry geometry = GeometryAtShare(GetParam(), 1e-3);
  const std::vector<BallOnWall> reference = ByReference(geometry), lanes = ByLanes(geometry);
  const auto length = [](const BallOnWall& ball) { return ball.last_flight; };
  const auto place = [](const BallOnWall& ball) { return Angles(ball)[0]; };
  const double joint = oracle::ChiSquareScore(JointCounts(reference), JointCounts(lanes));
  const double lengths =
      oracle::KolmogorovSmirnov(Values(reference, length), Values(lanes, length));
  const double places = oracle::KolmogorovSmirnov(Values(reference, place), Values(lanes, place));
  EXPECT_LT(joint, 4);
  EXPECT_LT(lengths, 2.3);
  EXPECT_LT(places, 2.3);
}

INSTANTIATE_TEST_SUITE_P(Radii, LongFlights,
                         testing::Values(0.5 + 1e-9, 0.501, kPaperRho, 0.7, kMaxRho - 1e-9));

}  // namespace
}  // namespace ballpiston
