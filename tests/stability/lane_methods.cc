#include "tests/stability/lane_methods.h"

#include <algorithm>
#include <cmath>

#include "tests/stability/ball_watch.h"
#include "tests/stability/event_methods.h"

namespace ballpiston::stability {
namespace {

constexpr size_t kBlock = 256;  // balls between calls of the engine: what a call costs is shared

std::vector<oracle::LaneBall> OnTheirWalls(std::span<const PairState> starts) {
  std::vector<oracle::LaneBall> balls;
  for (const PairState& start : starts) {
    balls.push_back({.frame = FrameOfBallOnWall(start.position, start.direction)});
  }
  return balls;
}

void FlyBlockWatched(FlyLanes fly, double epsilon, const PairGeometry& geometry,
                     std::span<const PairState> starts, uint64_t hits, Failures& failures) {
  std::vector<oracle::LaneBall> balls = OnTheirWalls(starts);
  std::vector<BallWatch> watches(starts.size(), BallWatch(geometry, epsilon));
  std::vector<char> flying(starts.size(), 1);
  size_t left = starts.size();
  failures.orbits += starts.size();
  for (uint64_t i = 0; i < hits && left > 0; ++i) {
    fly(geometry, 1, balls);
    for (size_t k = 0; k < balls.size(); ++k) {
      if (!flying[k]) continue;
      const LaneFrame& frame = balls[k].frame;
      failures.energy = std::max(failures.energy, std::fabs(SquaredLengthError(frame)));
      if (watches[k].Hit(PositionInCell(frame), DirectionInCell(frame), balls[k].shortest,
                         failures))
        continue;
      flying[k] = 0;
      --left;
    }
  }
}

PairState InCell(const LaneFrame& frame) {
  return {.position = PositionInCell(frame), .direction = DirectionInCell(frame), .ball_speed = 1};
}

}  // namespace

double SquaredLengthError(const LaneFrame& frame) {
  // h^2 + e^2 is near 1/2: with the squares fused in, little is rounded.
  return 2 * std::fma(frame.h, frame.h, std::fma(frame.e, frame.e, -0.5));
}

Failures FlyInLanesWatched(FlyLanes fly, double epsilon, const PairGeometry& geometry,
                           std::span<const PairState> starts, uint64_t hits) {
  Failures failures;
  for (size_t first = 0; first < starts.size(); first += kBlock) {
    FlyBlockWatched(fly, epsilon, geometry,
                    starts.subspan(first, std::min(kBlock, starts.size() - first)), hits, failures);
  }
  return failures;
}

std::vector<double> ThereAndBackInLanes(FlyLanes fly, const PairGeometry& geometry,
                                        std::span<const PairState> starts, uint64_t hits) {
  std::vector<oracle::LaneBall> balls = OnTheirWalls(starts);
  fly(geometry, hits, balls);
  std::vector<PairState> turned;
  for (const oracle::LaneBall& ball : balls) turned.push_back(Reversed(InCell(ball.frame)));
  balls = OnTheirWalls(turned);
  fly(geometry, hits, balls);
  std::vector<double> distances;
  for (size_t i = 0; i < balls.size(); ++i) {
    distances.push_back((PositionInCell(balls[i].frame) - starts[i].position).norm());
  }
  return distances;
}

}  // namespace ballpiston::stability
