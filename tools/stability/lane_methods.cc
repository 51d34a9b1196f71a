#include "tools/stability/lane_methods.h"

#include <algorithm>
#include <cmath>

#include "tools/stability/ball_watch.h"
#include "tools/stability/event_methods.h"

namespace ballpiston::stability {
namespace {

constexpr size_t kBlock = 256;  // balls per call of the engine; many balls share a call's cost

std::vector<LaneFrame> OnTheirWalls(std::span<const PairState> starts) {
  std::vector<LaneFrame> frames;
  for (const PairState& start : starts) {
    frames.push_back(FrameOfBallOnWall(start.position, start.direction));
  }
  return frames;
}

void FlyBlockWatched(FlyLanes fly, double epsilon, const PairGeometry& geometry,
                     std::span<const PairState> starts, uint64_t hits, Failures& failures) {
  std::vector<LaneFrame> frames = OnTheirWalls(starts);
  std::vector<LaneHit> hit(starts.size());
  std::vector<BallWatch> watches(starts.size(), BallWatch(geometry, epsilon));
  std::vector<char> flying(starts.size(), 1);
  size_t left = starts.size();
  failures.orbits += starts.size();
  for (uint64_t i = 0; i < hits && left > 0; ++i) {
    fly(geometry, frames, 1, hit);
    for (size_t k = 0; k < frames.size(); ++k) {
      frames[k] = hit[k].frame;
      if (!flying[k]) continue;
      const LaneFrame& frame = frames[k];
      failures.SeeEnergy(std::fabs(SquaredLengthError(frame)));
      if (watches[k].Hit(PositionInCell(frame), DirectionInCell(frame), hit[k].length, failures))
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
  // h^2 + e^2 is near 1/2. Fused multiply-add keeps the rounding error small.
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
  std::vector<LaneHit> last(starts.size());
  fly(geometry, OnTheirWalls(starts), hits, last);
  std::vector<PairState> turned;
  for (const LaneHit& hit : last) turned.push_back(Reversed(InCell(hit.frame)));
  fly(geometry, OnTheirWalls(turned), hits, last);
  std::vector<double> distances;
  for (size_t i = 0; i < last.size(); ++i) {
    distances.push_back((PositionInCell(last[i].frame) - starts[i].position).norm());
  }
  return distances;
}

}  // namespace ballpiston::stability
