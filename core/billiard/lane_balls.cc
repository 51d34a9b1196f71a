#include "core/billiard/lane_balls.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/billiard/lane_balls.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "core/billiard/lane_flight-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {

// Two groups of three vectors: without a piston to watch, three still fit. They stay in memory
// between flights, as the engine's do.
template <typename T>
class LaneBalls {
 public:
  explicit LaneBalls(const PairGeometry& geometry) : constants_(geometry) {}

  static size_t Count() { return kGroups * LanesInGroup(); }

  // Repeats the last one if there are fewer than Count(). Scales in place: a call out of this
  // instruction set costs hundreds of cycles on some processors, for every ball.
  void Begin(std::span<const LaneFrame> starts) {
    const double k = constants_.scale;
    for (size_t lane = 0; lane < Count(); ++lane) {
      const LaneFrame& f = starts[std::min(lane, starts.size() - 1)];
      const double columns[] = {f.h * k, f.e * k, f.c * k, f.s * k, f.a, f.b, f.m, 0, 0};
      for (size_t i = 0; i < kColumns; ++i) values_[i][lane] = static_cast<T>(columns[i]);
    }
  }

  // Always flies both groups, even for few balls. With a number of groups that the compiler does
  // not know, a flight took up to 1.7 times as long.
  void FlyAll() {
    for (size_t group = 0; group < kGroups; ++group) FlyGroup(group * LanesInGroup());
  }

  // Computes LaneHit::x of all balls. Call it before Hit().
  void FindAbscissae() {
    for (size_t group = 0; group < kGroups; ++group) FindAbscissaeOfGroup(group * LanesInGroup());
  }

  LaneHit Hit(size_t lane) const {
    const double k = constants_.scale;
    const auto at = [&](size_t i) { return static_cast<double>(values_[i][lane]); };
    const LaneFrame frame = {at(0), at(1), at(2), at(3), at(4), at(5), at(6)};
    return {Scaled(frame, 1 / k), at(7) / k, at(8) / (k * k)};
  }

 private:
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;
  static constexpr size_t kGroups = 2;
  static constexpr size_t K = 3;         // vectors in a group
  static constexpr size_t kColumns = 9;  // frame, length, abscissa

  static size_t LanesInGroup() { return K * hn::Lanes(D()); }

  HWY_INLINE void Get(size_t column, size_t first, V (&v)[K]) const {
    BALLPISTON_EACH v[i] = hn::Load(D(), values_[column] + first + i * hn::Lanes(D()));
  }
  HWY_INLINE void Put(const V (&v)[K], size_t column, size_t first) {
    BALLPISTON_EACH { hn::Store(v[i], D(), values_[column] + first + i * hn::Lanes(D())); }
  }

  HWY_INLINE void GetBalls(size_t first, Balls<D, K>& balls) const {
    Get(0, first, balls.h);
    Get(1, first, balls.e);
    Get(2, first, balls.c);
    Get(3, first, balls.s);
    Get(4, first, balls.a);
    Get(5, first, balls.b);
    Get(6, first, balls.m);
  }

  HWY_INLINE void FlyGroup(size_t first) {
    Balls<D, K> balls;
    V length[K], missed[K];
    GetBalls(first, balls);
    Fly(D(), constants_, balls, length, missed);
    Put(balls.h, 0, first);
    Put(balls.e, 1, first);
    Put(balls.c, 2, first);
    Put(balls.s, 3, first);
    Put(balls.a, 4, first);
    Put(balls.b, 5, first);
    Put(balls.m, 6, first);
    Put(length, 7, first);
  }

  void FindAbscissaeOfGroup(size_t first) {
    Balls<D, K> balls;
    V x[K];
    GetBalls(first, balls);
    Abscissae(D(), constants_, balls, T(0), x);
    Put(x, 8, first);
  }

  FlightConstants<T> constants_;
  HWY_ALIGN T values_[kColumns][kGroups * K * HWY_MAX_BYTES / sizeof(T)];
};

template <typename T>
void FlyBalls(const PairGeometry& geometry, std::span<const LaneFrame> starts, uint64_t hits,
              std::span<LaneHit> recorded) {
  LaneBalls<T> balls(geometry);
  const size_t records = recorded.empty() ? 0 : recorded.size() / starts.size();
  assert(recorded.empty() || (records > 0 && hits % records == 0));
  const uint64_t between = recorded.empty() ? hits : hits / records;
  for (size_t first = 0; first < starts.size(); first += balls.Count()) {
    const size_t count = std::min(balls.Count(), starts.size() - first);
    balls.Begin(starts.subspan(first, count));
    for (uint64_t done = 0; done < hits; done += between) {
      for (uint64_t k = 0; k < between; ++k) balls.FlyAll();
      if (recorded.empty()) continue;
      balls.FindAbscissae();
      const size_t record = done / between;
      for (size_t i = 0; i < count; ++i) recorded[(first + i) * records + record] = balls.Hit(i);
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
