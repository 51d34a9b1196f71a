#include "tools/flows/lane_balls.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/flows/lane_balls.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

#include "core/billiard/lane_flight-inl.h"
#include "core/billiard/lane_frame.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {

// The ball's x in the cell. It has less rounding than PositionInCell, which computes the components
// in the frame first.
inline double Abscissa(const LaneFrame& f) {
  // (q_x + q_y - 1)/2 and (q_x - q_y)/2, for x = (q - (1, 1)/2) . r.
  const double along = f.s * f.h - 0.5 - f.c * f.e, across = f.s * f.e + f.c * f.h;
  return f.a * along + f.b * across;
}

// Several vectors, each in a stage of a flight: while a vector is in Aim, the vector kLag before it
// is in FindRoot, and the vector 2 kLag before it is in Turn.
template <typename T>
class LaneBalls {
 public:
  explicit LaneBalls(const PairGeometry& geometry) : constants_(geometry) {}

  static size_t Count() { return kVectors * Width(); }

  // Repeats the last start if there are fewer than Count().
  void Begin(std::span<const LaneFrame> starts) {
    for (size_t i = 0; i < Count(); ++i) {
      const LaneFrame& frame = starts[std::min(i, starts.size() - 1)];
      vectors_[i / Width()].Set(i % Width(), Scaled(frame, constants_.scale));
    }
  }

  // All balls, `hits` > 0 flights of each.
  void Fly(uint64_t hits) {
    const FlightConstants<T> k = constants_;  // a copy that no store into the lanes can change
    for (size_t i = 0; i < 2 * kLag; ++i) {
      AimOf(k, i);
      if (i >= kLag) FindRootOf(i - kLag);
    }
    for (uint64_t flight = 0; flight + 1 < hits; ++flight) FlyOn(k);
    for (size_t i = 2 * kLag; i < kVectors + 2 * kLag; ++i) {
      if (i < kVectors) AimOf(k, i);
      if (i < kVectors + kLag) FindRootOf(i - kLag);
      TurnOf(k, i - 2 * kLag);
    }
  }

  LaneHit Hit(size_t i) const {
    const Balls<T>& vector = vectors_[i / Width()];
    const double scale = constants_.scale;
    const LaneFrame frame = Scaled(vector.Frame(i % Width()), 1 / scale);
    return {frame, static_cast<double>(vector.path[i % Width()]) / scale, Abscissa(frame)};
  }

 private:
  static constexpr size_t kVectors = 8;
  static constexpr size_t kLag = 3;

  static size_t Width() { return hn::Lanes(hn::ScalableTag<T>()); }

  // One flight of each vector; begins when vector 2 kLag is about to enter Aim.
  HWY_INLINE void FlyOn(const FlightConstants<T>& k) {
    _Pragma("GCC unroll 16") for (size_t i = 0; i < kVectors; ++i) {
      TurnOf(k, i);
      FindRootOf((i + kLag) % kVectors);
      AimOf(k, (i + 2 * kLag) % kVectors);
    }
  }

  HWY_INLINE void AimOf(const FlightConstants<T>& k, size_t i) { Aim(k, vectors_[i], vectors_[i]); }
  HWY_INLINE void FindRootOf(size_t i) { FindRoot(vectors_[i]); }
  HWY_INLINE void TurnOf(const FlightConstants<T>& k, size_t i) {
    Turn(k, hn::Zero(hn::ScalableTag<T>()), vectors_[i]);
  }

  FlightConstants<T> constants_;
  Balls<T> vectors_[kVectors] = {};  // `path` is that of the last flight
};

template <typename T>
void FlyBalls(const PairGeometry& geometry, std::span<const LaneFrame> starts, uint64_t hits,
              std::span<LaneHit> recorded) {
  LaneBalls<T> balls(geometry);
  const uint64_t at_once = recorded.empty() ? hits : 1;
  for (size_t first = 0; first < starts.size(); first += balls.Count()) {
    const size_t count = std::min(balls.Count(), starts.size() - first);
    balls.Begin(starts.subspan(first, count));
    for (uint64_t done = 0; done < hits; done += at_once) {
      balls.Fly(at_once);
      if (recorded.empty()) continue;
      for (size_t i = 0; i < count; ++i) recorded[(first + i) * hits + done] = balls.Hit(i);
    }
  }
}

void FlyBallsDouble(const PairGeometry& geometry, std::span<const LaneFrame> starts, uint64_t hits,
                    std::span<LaneHit> recorded) {
  FlyBalls<double>(geometry, starts, hits, recorded);
}

void FlyBallsSingle(const PairGeometry& geometry, std::span<const LaneFrame> starts, uint64_t hits,
                    std::span<LaneHit> recorded) {
  FlyBalls<float>(geometry, starts, hits, recorded);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(FlyBallsDouble);
HWY_EXPORT(FlyBallsSingle);

std::vector<LaneFrame> OnTheirWalls(std::span<const PairState> starts) {
  std::vector<LaneFrame> frames;
  for (const PairState& start : starts) {
    frames.push_back(FrameOfBallOnWall(start.position, start.direction));
  }
  return frames;
}

void FlyLaneBalls(const PairGeometry& geometry, std::span<const LaneFrame> starts, uint64_t hits,
                  std::span<LaneHit> recorded) {
  HWY_DYNAMIC_DISPATCH(FlyBallsDouble)(geometry, starts, hits, recorded);
}

void FlyLaneBallsSingle(const PairGeometry& geometry, std::span<const LaneFrame> starts,
                        uint64_t hits, std::span<LaneHit> recorded) {
  HWY_DYNAMIC_DISPATCH(FlyBallsSingle)(geometry, starts, hits, recorded);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
