#include "tests/oracle/lane_balls.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/oracle/lane_balls.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

#include "core/billiard/lane_flight-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {

// One vector of balls, in memory between calls.
template <typename T>
struct LaneColumns {
  static constexpr size_t kMost = HWY_MAX_BYTES / sizeof(T);
  static constexpr size_t kColumns = 11;
  HWY_ALIGN T values[kColumns][kMost];

  void Set(size_t lane, const oracle::LaneBall& ball, double scale) {
    const LaneFrame f = Scaled(ball.frame, scale);
    const double from[kColumns] = {f.h, f.e, f.c, f.s, f.a, f.b, f.m, 0, ball.path * scale, 1e9, 0};
    for (size_t i = 0; i < kColumns; ++i) values[i][lane] = static_cast<T>(from[i]);
  }

  oracle::LaneBall Get(size_t lane, double scale) const {
    const auto at = [&](size_t i) { return static_cast<double>(values[i][lane]); };
    return {.frame = Scaled({at(0), at(1), at(2), at(3), at(4), at(5), at(6)}, 1 / scale),
            .length = at(7) / scale,
            .path = at(8) / scale,
            .shortest = at(9) / scale,
            .x = at(10) / (scale * scale)};
  }
};

template <typename T>
void FlyVector(const FlightConstants<T>& constants, uint64_t flights, LaneColumns<T>& columns) {
  using D = hn::ScalableTag<T>;
  const D d;
  const auto at = [&](size_t i) { return hn::Load(d, columns.values[i]); };
  Balls<D, 1> balls = {{at(0)}, {at(1)}, {at(2)}, {at(3)}, {at(4)}, {at(5)}, {at(6)}};
  hn::Vec<D> length[1] = {at(7)}, x[1] = {at(10)};
  auto path = at(8), shortest = at(9);
  for (uint64_t i = 0; i < flights; ++i) {
    Fly(d, constants, balls, length);
    path = hn::Add(path, length[0]);
    shortest = hn::Min(shortest, length[0]);
  }
  Abscissae(d, constants, balls, T(0), x);
  const hn::Vec<D> results[] = {balls.h[0], balls.e[0], balls.c[0], balls.s[0],
                                balls.a[0], balls.b[0], balls.m[0], length[0],
                                path,       shortest,   x[0]};
  for (size_t i = 0; i < columns.kColumns; ++i) hn::Store(results[i], d, columns.values[i]);
}

template <typename T>
void FlyAll(const PairGeometry& geometry, uint64_t flights, std::span<oracle::LaneBall> balls) {
  const FlightConstants<T> constants(geometry);
  const size_t width = hn::Lanes(hn::ScalableTag<T>());
  for (size_t first = 0; first < balls.size(); first += width) {
    LaneColumns<T> columns;
    const size_t count = std::min(width, balls.size() - first);
    for (size_t i = 0; i < width; ++i) {
      columns.Set(i, balls[first + std::min(i, count - 1)], constants.scale);
    }
    FlyVector(constants, flights, columns);
    for (size_t i = 0; i < count; ++i) balls[first + i] = columns.Get(i, constants.scale);
  }
}

void FlyDouble(const PairGeometry& geometry, uint64_t flights, std::span<oracle::LaneBall> balls) {
  FlyAll<double>(geometry, flights, balls);
}

void FlySingle(const PairGeometry& geometry, uint64_t flights, std::span<oracle::LaneBall> balls) {
  FlyAll<float>(geometry, flights, balls);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(FlyDouble);
HWY_EXPORT(FlySingle);

namespace oracle {

void FlyInLanes(const PairGeometry& geometry, uint64_t flights, std::span<LaneBall> balls) {
  HWY_DYNAMIC_DISPATCH(FlyDouble)(geometry, flights, balls);
}

void FlyInLanesSingle(const PairGeometry& geometry, uint64_t flights, std::span<LaneBall> balls) {
  HWY_DYNAMIC_DISPATCH(FlySingle)(geometry, flights, balls);
}

}  // namespace oracle
}  // namespace ballpiston
#endif  // HWY_ONCE
