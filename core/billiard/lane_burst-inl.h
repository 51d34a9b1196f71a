// A burst: some flights of several vectors of balls. The burst keeps the state before and after
// every flight, and the lanes whose ball is within a piston's reach. Included once for each
// instruction set.
//
// Slot t is the state before flight t, slot t + kVectors the state after it, and t % kVectors is
// the vector. The vectors' flights overlap (lane_flight-inl.h): while a vector is in the stage Aim,
// the vector kLag before it is in FindRoot, and the vector 2 kLag before it is in Turn. More
// vectors would not fit into the first-level cache.
#if defined(BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_
#undef BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_
#else
#define BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/billiard/lane_flight-inl.h"
#include "core/geometry/pair_geometry.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kVectors = 6;
constexpr size_t kLag = 2;
constexpr size_t kMostFlights = 12;  // of a lane in a burst
constexpr size_t kMostSteps = kVectors * kMostFlights;

// Rounding in the lanes must not hide a contact; a false alarm costs little.
template <typename T>
inline constexpr double kSlack = sizeof(T) == 8 ? 1e-11 : 1e-3;

// The largest c'^2 - 2 that counts as a rounding error. Rounding causes a few ulps.
template <typename T>
inline constexpr T kMissedByRounding = sizeof(T) == 8 ? T(1e-12) : T(1e-5);

// The place on an arc, in the lanes' units, from which the piston at the arc's tip can reach the
// arc. Places are measured along the arc from its middle: (q_x - q_y)/2.
template <typename T>
T EdgeOfReach(const PairGeometry& geometry, double scale) {
  // The arc with the right tip is x = 1/2 + rho sin(angle - 45 degrees), up to 45 degrees.
  const double left = geometry.piston_left() - kSlack<T>;
  const double sine = std::max((left - 0.5) / geometry.rho(), -1.0);
  return static_cast<T>(scale * std::sin(std::asin(sine) + M_PI_4));
}

// The lanes whose ball, on a wall, is within reach of a piston: at the arc's tip toward -y of the
// frame (above), or at the tip toward -x (below).
struct TipsInReach {
  uint32_t above, below;
};

template <typename T>
HWY_INLINE TipsInReach TipsOf(const Balls<T>& balls, T edge) {
  const hn::ScalableTag<T> d;
  const auto h = hn::Load(d, balls.h), e = hn::Load(d, balls.e);
  const auto across = hn::MulAdd(hn::Load(d, balls.c), h, hn::Mul(hn::Load(d, balls.s), e));
  return {Bits(d, hn::Gt(across, hn::Set(d, edge))), Bits(d, hn::Lt(across, hn::Set(d, -edge)))};
}

// Computes `flights` flights of each vector. `reach(balls)` returns the lanes in reach of a piston;
// in_reach[t] keeps them for each slot except the first kVectors. Returns true if a ball has left
// its cell.
template <typename T, class Reach>
HWY_INLINE bool FlyBurst(const FlightConstants<T>& constants, size_t flights, const Reach& reach_of,
                         Balls<T>* HWY_RESTRICT slots, uint16_t* HWY_RESTRICT in_reach) {
  const FlightConstants<T> k = constants;  // copies that no store into the lanes can change
  const Reach reach = reach_of;
  const hn::ScalableTag<T> d;
  const size_t steps = flights * kVectors;
  auto worst = hn::Zero(d);
  const auto end_flight = [&](size_t t) HWY_ATTR {
    Turn(k, hn::Load(d, slots[t].path), slots[t + kVectors]);
    in_reach[t + kVectors] = static_cast<uint16_t>(reach(slots[t + kVectors]));
  };
  for (size_t t = 0; t < 2 * kLag; ++t) {
    if (t >= kLag) FindRoot(slots[t - kLag + kVectors]);
    worst = hn::Min(Aim(k, slots[t], slots[t + kVectors]), worst);
  }
  for (size_t t = 0; t < steps - 2 * kLag; ++t) {
    end_flight(t);
    FindRoot(slots[t + kLag + kVectors]);
    worst = hn::Min(Aim(k, slots[t + 2 * kLag], slots[t + 2 * kLag + kVectors]), worst);
  }
  for (size_t t = steps - 2 * kLag; t < steps; ++t) {
    end_flight(t);
    if (t + kLag < steps) FindRoot(slots[t + kLag + kVectors]);
  }
  return SignBits(d, hn::Add(worst, hn::Set(d, kMissedByRounding<T>))) != 0;
}

// FlyBurst for one vector, whose flights do not overlap: slot t + 1 is after flight t.
template <typename T, class Reach>
HWY_INLINE bool FlyOneVector(const FlightConstants<T>& constants, size_t flights,
                             const Reach& reach, Balls<T>* HWY_RESTRICT slots,
                             uint16_t* HWY_RESTRICT in_reach) {
  const FlightConstants<T> k = constants;
  const hn::ScalableTag<T> d;
  auto worst = hn::Zero(d);
  for (size_t t = 0; t < flights; ++t) {
    worst = hn::Min(Aim(k, slots[t], slots[t + 1]), worst);
    FindRoot(slots[t + 1]);
    Turn(k, hn::Load(d, slots[t].path), slots[t + 1]);
    in_reach[t + 1] = static_cast<uint16_t>(reach(slots[t + 1]));
  }
  return SignBits(d, hn::Add(worst, hn::Set(d, kMissedByRounding<T>))) != 0;
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#endif
