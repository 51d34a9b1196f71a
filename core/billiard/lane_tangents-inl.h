// The tangent maps of the balls' flights in the lanes (tangent_map.h), beside the flights of a
// burst. Included once for each instruction set.
//
// The burst keeps every flight's length L and s' = rho cos(phi) at its end, both in units of
// rho/sqrt(2). In the same unit of length a flight adds L theta to a, and a hit adds (2/s') a to
// theta. After each burst the map is divided by a power of two, so it never overflows.
#if defined(BALLPISTON_CORE_BILLIARD_LANE_TANGENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_BILLIARD_LANE_TANGENTS_INL_H_
#undef BALLPISTON_CORE_BILLIARD_LANE_TANGENTS_INL_H_
#else
#define BALLPISTON_CORE_BILLIARD_LANE_TANGENTS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/billiard/lane_burst-inl.h"
#include "core/billiard/lane_flight-inl.h"
#include "core/billiard/tangent_map.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename T>
class LaneTangents {
 public:
  // An orbit enters the lane at the beginning of a burst.
  void Restart(size_t vector, size_t lane) {
    Maps& maps = maps_[vector];
    maps.aa[lane] = maps.tt[lane] = 1;
    maps.at[lane] = maps.ta[lane] = 0;
    maps.exponent[lane] = 0;
  }

  // Takes the flights of a burst.
  HWY_INLINE void FollowBurst(const LaneBurst<T>& burst, size_t flights) {
    for (size_t v = 0; v < kVectors; ++v) FollowVector(burst, v, flights);
  }

  // The map of a wait that ends in flight t of the burst, when the ball has gone `way` in it, in
  // cells; `scale` is that of the lanes' lengths. The burst must not be followed yet.
  BallMap MapTo(const LaneBurst<T>& burst, size_t t, size_t lane, double way, double scale) const {
    const size_t vector = t % kVectors;
    const Maps& maps = maps_[vector];
    double aa = maps.aa[lane], at = maps.at[lane], ta = maps.ta[lane], tt = maps.tt[lane];
    const auto fly = [&](double length) {
      aa += length * ta;
      at += length * tt;
    };
    for (size_t slot = vector; slot < t; slot += kVectors) {
      const Balls<T>&from = burst.slot(slot), &to = burst.slot(slot + kVectors);
      fly(static_cast<double>(to.path[lane] - from.path[lane]));
      const double kick = 2 / std::max(static_cast<double>(to.s[lane]), kSmallestRoot);
      ta += kick * aa;
      tt += kick * at;
    }
    fly(way * scale);
    return {aa, at / scale, ta * scale, tt, static_cast<double>(maps.exponent[lane])};
  }

 private:
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;
  using Integers = hn::RebindToSigned<D>;
  using Integer = hn::TFromD<Integers>;

  static constexpr double kSmallestRoot = kSmallestCosine<T> * M_SQRT2;

  struct Maps {
    HWY_ALIGN T aa[kMostLanes<T>], at[kMostLanes<T>], ta[kMostLanes<T>], tt[kMostLanes<T>];
    HWY_ALIGN Integer exponent[kMostLanes<T>];
  };

  HWY_INLINE void FollowVector(const LaneBurst<T>& burst, size_t v, size_t flights) {
    const D d;
    Maps& maps = maps_[v];
    V aa = hn::Load(d, maps.aa), at = hn::Load(d, maps.at);
    V ta = hn::Load(d, maps.ta), tt = hn::Load(d, maps.tt);
    V from = hn::Load(d, burst.slot(v).path);
    for (size_t t = v + kVectors; t <= v + flights * kVectors; t += kVectors) {
      const V to = hn::Load(d, burst.slot(t).path), length = hn::Sub(to, from);
      const V root = hn::Max(hn::Load(d, burst.slot(t).s), hn::Set(d, T(kSmallestRoot)));
      const V kick = hn::Div(hn::Set(d, T(2)), root);
      aa = hn::MulAdd(length, ta, aa);
      at = hn::MulAdd(length, tt, at);
      ta = hn::MulAdd(kick, aa, ta);
      tt = hn::MulAdd(kick, at, tt);
      from = to;
    }
    Shrink(aa, at, ta, tt, maps);
  }

  // Divides by the power of two of the largest element, and counts it.
  HWY_INLINE void Shrink(V aa, V at, V ta, V tt, Maps& maps) {
    constexpr int kDigits = sizeof(T) == 8 ? 52 : 23;
    constexpr Integer kBias = sizeof(T) == 8 ? 1023 : 127;
    const D d;
    const Integers i;
    const V largest = hn::Max(hn::Max(hn::Abs(aa), hn::Abs(at)), hn::Max(hn::Abs(ta), hn::Abs(tt)));
    const auto power = hn::Sub(hn::ShiftRight<kDigits>(hn::BitCast(i, largest)), hn::Set(i, kBias));
    const V factor = hn::BitCast(d, hn::ShiftLeft<kDigits>(hn::Sub(hn::Set(i, kBias), power)));
    hn::Store(hn::Mul(aa, factor), d, maps.aa);
    hn::Store(hn::Mul(at, factor), d, maps.at);
    hn::Store(hn::Mul(ta, factor), d, maps.ta);
    hn::Store(hn::Mul(tt, factor), d, maps.tt);
    hn::Store(hn::Add(hn::Load(i, maps.exponent), power), i, maps.exponent);
  }

  std::array<Maps, kVectors> maps_ = {};
};

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#endif
