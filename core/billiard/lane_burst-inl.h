// The engines of the pair and of the gas both use this file. It has the burst and a test. A burst
// computes some flights of several vectors of balls. The test tells whether ball and piston may
// have met in a flight. Included once for each instruction set.
//
// The burst keeps the state before and after every flight, and the lanes whose ball is within a
// piston's reach. Slot t is the state before flight t, slot t + kVectors the state after it, and t
// % kVectors is the vector. More vectors would not fit into the first-level cache.
#if defined(BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_
#undef BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_
#else
#define BALLPISTON_CORE_BILLIARD_LANE_BURST_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/billiard/lane_constants.h"
#include "core/billiard/lane_flight-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kVectors = 6;
constexpr size_t kLag = 2;
constexpr size_t kMostSteps = kVectors * kMostFlights;

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

// The pistons of a vector of balls: triangle waves (piston_wave.h) whose phases, in periods, are
// linear in the balls' paths.
template <typename T>
struct PistonWaves {
  HWY_ALIGN T phase[kMostLanes<T>];  // at path 0
  HWY_ALIGN T ratio[kMostLanes<T>];  // periods of the piston in a unit of the ball's path

  HWY_INLINE hn::Vec<hn::ScalableTag<T>> PhaseAfter(hn::Vec<hn::ScalableTag<T>> path) const {
    const hn::ScalableTag<T> d;
    return hn::MulAdd(hn::Load(d, ratio), path, hn::Load(d, phase));
  }
};

// The balls' places in their cells, from the centre, in squared units: x to the right, y up.
template <typename T>
class PlacesInCell {
 public:
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;

  HWY_INLINE PlacesInCell(const Balls<T>& balls, T half_height)
      : a_(balls.a), b_(balls.a ^ balls.ab), m_(balls.m) {
    const D d;
    const V h = hn::Load(d, balls.h), e = hn::Load(d, balls.e), c = hn::Load(d, balls.c),
            s = hn::Load(d, balls.s);
    along_ = hn::NegMulAdd(c, e, hn::MulSub(s, h, hn::Set(d, half_height)));
    across_ = hn::MulAdd(c, h, hn::Mul(s, e));
  }

  HWY_INLINE V X() const { return hn::Add(NegatedIn(a_, along_), NegatedIn(b_, across_)); }
  HWY_INLINE V Y() const {
    return hn::Sub(NegatedIn(m_ ^ b_, along_), NegatedIn(m_ ^ a_, across_));
  }

 private:
  static HWY_INLINE V NegatedIn(uint32_t lanes, V v) {
    const uint8_t bytes[8] = {static_cast<uint8_t>(lanes), static_cast<uint8_t>(lanes >> 8)};
    return hn::IfThenElse(hn::LoadMaskBits(D(), bytes), hn::Neg(v), v);
  }

  uint32_t a_, b_, m_;
  V along_, across_;
};

// The lanes in which a ball, in a flight from x0 to x1, and the piston on its right, at these
// phases then, may have met.
//
// The distance between ball and piston is a concave function of time, except where the piston turns
// at its left wall. So they met if the ball ends beyond the piston, or was in reach when the piston
// turned for the first or the last time in the flight.
template <typename T, class V = hn::Vec<hn::ScalableTag<T>>>
HWY_INLINE uint32_t MayHaveMet(const ReachConstants<T>& k, V x0, V x1, V before, V after) {
  const hn::ScalableTag<T> d;
  x0 = hn::Sub(x0, hn::Set(d, k.left));
  x1 = hn::Sub(x1, hn::Set(d, k.left));
  const V gain = hn::Sub(x1, x0);
  const V turns = hn::Floor(after), last = hn::Floor(before);
  const V phase0 = hn::Sub(before, last), phase1 = hn::Sub(after, turns);
  const V one = hn::Set(d, T(1)), way = hn::Sub(after, before);
  const V distance = hn::Mul(hn::Min(phase1, hn::Sub(one, phase1)), hn::Set(d, k.period));
  // Times `way`: x0 + gain (1 - phase0)/way, and x1 - gain phase1/way.
  const V at_first = hn::MulAdd(gain, hn::Sub(one, phase0), hn::Mul(x0, way));
  const V at_last = hn::NegMulAdd(gain, phase1, hn::Mul(x1, way));
  const uint32_t beyond = Bits(d, hn::Gt(x1, distance));
  const uint32_t turned =
      Bits(d, hn::Gt(turns, last)) & Bits(d, hn::Gt(hn::Max(at_first, at_last), hn::Zero(d)));
  return beyond | turned;
}

template <typename T>
class LaneBurst {
 public:
  // A flight of the burst to look at, and lanes in which something may have happened.
  struct FlightOfLanes {
    uint32_t flight, lanes;
  };

  Balls<T>& slot(size_t t) { return slots_[t]; }
  const Balls<T>& slot(size_t t) const { return slots_[t]; }
  // The lanes whose ball is in a piston's reach before flight t.
  uint16_t& in_reach(size_t t) { return in_reach_[t]; }
  uint16_t in_reach(size_t t) const { return in_reach_[t]; }
  // The lanes whose ball was in reach before or after flight t.
  uint32_t InReachAround(size_t t) const { return in_reach_[t] | in_reach_[t + kVectors]; }
  // Whether a ball has left its cell.
  bool left_cell() const { return left_cell_; }

  // Computes `flights` flights of each vector. `reach(balls)` returns the lanes in reach of a
  // piston. The vectors' flights overlap (lane_flight-inl.h): while a vector is in the stage Aim,
  // the vector kLag before it is in FindRoot, and the vector 2 kLag before it is in Turn.
  template <class Reach>
  HWY_INLINE void Fly(const FlightConstants<T>& constants, size_t flights, const Reach& reach_of) {
    const FlightConstants<T> k = constants;  // copies that no store into the lanes can change
    const Reach reach = reach_of;
    const D d;
    const size_t steps = steps_ = flights * kVectors;
    auto worst = hn::Zero(d);
    Balls<T>* HWY_RESTRICT slots = slots_;
    uint16_t* HWY_RESTRICT in_reach = in_reach_;
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
    left_cell_ = HasMissed(worst);
  }

  // The same for the first vectors only, whose stages follow each other. The others' flights count
  // as out of reach.
  template <class Reach>
  HWY_INLINE void FlyFew(const FlightConstants<T>& constants, size_t vectors, size_t flights,
                         const Reach& reach) {
    const FlightConstants<T> k = constants;
    const D d;
    steps_ = flights * kVectors;
    std::memset(in_reach_ + vectors, 0, (steps_ + kVectors - vectors) * sizeof(in_reach_[0]));
    auto worst = hn::Zero(d);
    for (size_t first = 0; first < steps_; first += kVectors) {
      for (size_t t = first; t < first + vectors; ++t) {
        worst = hn::Min(Aim(k, slots_[t], slots_[t + kVectors]), worst);
      }
      for (size_t t = first; t < first + vectors; ++t) FindRoot(slots_[t + kVectors]);
      for (size_t t = first; t < first + vectors; ++t) {
        Turn(k, hn::Load(d, slots_[t].path), slots_[t + kVectors]);
        in_reach_[t + kVectors] = static_cast<uint16_t>(reach(slots_[t + kVectors]));
      }
    }
    left_cell_ = HasMissed(worst);
  }

  std::span<const FlightOfLanes> listed() const { return {listed_, listed_end_}; }

  void ListAll() {
    listed_end_ = listed_;
    for (uint32_t t = 0; t < steps_; ++t) *listed_end_++ = {t, ~0U};
  }

  // Lists the flights that began or ended in a piston's reach.
  void ListFlightsInReach() {
    const hn::CappedTag<uint16_t, 32> d;
    listed_end_ = listed_;
    for (size_t t = 0; t < steps_; t += hn::Lanes(d)) {
      const auto in_reach =
          hn::Or(hn::LoadU(d, in_reach_ + t), hn::LoadU(d, in_reach_ + t + kVectors));
      uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hn::Ne(in_reach, hn::Zero(d)), bytes);
      uint64_t bits;
      std::memcpy(&bits, bytes, sizeof(bits));
      if (steps_ - t < hn::Lanes(d)) bits &= (uint64_t{1} << (steps_ - t)) - 1;
      for (; bits != 0; bits &= bits - 1) {
        const uint64_t first = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
        *listed_end_++ = {static_cast<uint32_t>(t + first), ~0U};
      }
    }
  }

  // Keeps, of the listed flights, the lanes in which `test` finds something; if a ball has left its
  // cell, all flights. The list is compacted without a branch, because that branch would often be
  // mispredicted.
  template <typename Test>
  HWY_INLINE void Keep(const Test& test) {
    FlightOfLanes* kept = listed_;
    for (const FlightOfLanes* f = listed_; f != listed_end_; ++f) {
      const uint32_t t = f->flight, lanes = test(t) & f->lanes;
      *kept = {t, lanes};
      kept += static_cast<size_t>(lanes != 0) | static_cast<size_t>(left_cell_);
    }
    listed_end_ = kept;
  }

 private:
  using D = hn::ScalableTag<T>;

  static bool HasMissed(hn::Vec<D> worst) {
    const D d;
    return SignBits(d, hn::Add(worst, hn::Set(d, kMissedByRounding<T>))) != 0;
  }

  Balls<T> slots_[kMostSteps + kVectors];
  uint16_t in_reach_[kMostSteps + kVectors + 32] = {};  // with room for a vector beyond
  size_t steps_ = 0;                                    // flights of all vectors
  bool left_cell_ = false;
  FlightOfLanes listed_[kMostSteps];
  FlightOfLanes* listed_end_ = listed_;
};

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#endif
