// One lane of flights, as plain functions that a processor and a GPU execute: the flight of
// billiard/lane_flight-inl.h, the burst and the tests of billiard/lane_burst-inl.h, one ball
// instead of a vector. Those files derive the formulas and define the symbols and units. Every
// operation here is the same operation, in the same order, as there: exact, correctly rounded, or
// fused where std::fma is written. So the bits are the same, if the compiler does not fuse other
// operations.
//
// A sign of the compass is in the top bit of a word: set for -1. The other bits have no meaning.
// Tests are signs too, so that integer units compute them: a GPU has fewer units for doubles.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#ifdef __CUDACC__
#define BALLPISTON_HOST_DEVICE __host__ __device__ __forceinline__
#else
#define BALLPISTON_HOST_DEVICE inline
#endif

namespace ballpiston {

// FlightConstants, ReachConstants and the length of a burst (billiard/lane_constants.h).
struct FlightProgram {
  double sqrt_2, half_height, length_squared, tip;  // of a flight
  double left, period, phase_at_tip, edge;          // of the piston's reach
  double missed_by_rounding;
  uint32_t flights;      // of a burst
  uint32_t looks_first;  // whether PistonMayBeNear comes before MayHaveMet
};

struct FlightBall {
  double h, e, c, s;
  double path;        // in this burst
  uint32_t a, ab, m;  // compass; ab is set where a and b have different signs
};

// A lane between two bursts.
struct FlightLane {
  FlightBall ball;
  double phase;         // of the piston, at path 0
  double ratio;         // periods of the piston in a unit of the ball's path
  double path_before;   // of the ball in the orbit's earlier bursts
  double longest_path;  // the orbit is overdue if path_before is longer
  uint64_t bursts;      // earlier ones of the orbit
  uint32_t in_reach;    // top bit: the ball is within the piston's reach
  uint32_t orbit;       // its number in the engine
};

enum class FlightNews : uint32_t { kNone, kMayHaveMet, kEscaped, kOverdue };

// What ends the flights of a lane. `lane` is as before the flight in which it happened.
struct FlightReport {
  FlightLane lane;
  double path_after;  // of the ball in this burst, after that flight
  uint32_t flight;    // its number in the burst
  FlightNews news;
};

inline constexpr uint32_t kNoOrbit = ~uint32_t{0};
inline constexpr uint32_t kSign = 0x80000000;

// ---- bits of a double ----

BALLPISTON_HOST_DEVICE uint32_t UpperWord(double x) {
#ifdef __CUDA_ARCH__
  return static_cast<uint32_t>(__double2hiint(x));
#else
  return static_cast<uint32_t>(std::bit_cast<uint64_t>(x) >> 32);
#endif
}

// x, or -x where the sign is set.
BALLPISTON_HOST_DEVICE double Negated(double x, uint32_t sign) {
#ifdef __CUDA_ARCH__
  return __hiloint2double(static_cast<int>(UpperWord(x) ^ (sign & kSign)), __double2loint(x));
#else
  return std::bit_cast<double>(std::bit_cast<uint64_t>(x) ^ uint64_t{sign & kSign} << 32);
#endif
}

BALLPISTON_HOST_DEVICE bool IsSet(uint32_t sign) { return static_cast<int32_t>(sign) < 0; }

BALLPISTON_HOST_DEVICE double PositivePart(double x) { return IsSet(UpperWord(x)) ? 0.0 : x; }

// ---- a flight ----

// Returns s'^2, as Aim does.
BALLPISTON_HOST_DEVICE double Fly(const FlightProgram& k, FlightBall& ball) {
  const double side = ball.c + ball.e;
  const uint32_t mirrored = UpperWord(side);
  const double h = ball.h, e = Negated(ball.e, mirrored);
  const double c = std::fabs(side);
  const double y = h - e, x = h + e;
  const double below_tip = std::fma(-y, k.tip, c);
  const double c1 = c - h;
  const double foot1 = x - ball.s;
  const double chord = std::fma(x, c1, k.half_height);
  const uint32_t ahead =
      UpperWord(below_tip) & (UpperWord(foot1) | UpperWord(c1 + k.sqrt_2) | UpperWord(chord));
  const double x_ahead = IsSet(ahead) ? x : 0.0, y_ahead = IsSet(ahead) ? y : 0.0;
  const double n = h - x_ahead, h2 = e + y_ahead;
  const double next_c = c - n;
  const double square = std::fma(-next_c, next_c, 2.0);
  const double foot = foot1 + y_ahead;

  ball.ab ^= mirrored;
  ball.a = ~(ball.a ^ (ball.ab & ~ahead));
  ball.ab ^= ~ahead;
  ball.m ^= mirrored;

  ball.s = std::sqrt(PositivePart(square));
  const double unit = std::fma(-std::fma(n, n, h2 * h2), k.length_squared, 1.5);
  const double p = std::fma(square, unit, -unit);
  const double r = (next_c * unit) * ball.s;
  ball.h = std::fma(-n, r, h2 * p);
  ball.e = std::fma(-h2, r, -(n * p));
  ball.c = next_c;
  const double length = foot - ball.s;
  ball.path += PositivePart(length);
  return square;
}

// ---- the piston ----

// The place on the arc (PlacesInCell::across_), which tells whether a tip is in reach.
BALLPISTON_HOST_DEVICE double PlaceOnArc(const FlightBall& ball) {
  return std::fma(ball.c, ball.h, ball.s * ball.e);
}

// Set if the ball is within the piston's reach: the arc must be at the right tip.
BALLPISTON_HOST_DEVICE uint32_t InReach(const FlightProgram& k, const FlightBall& ball) {
  return ball.a & UpperWord(k.edge - Negated(PlaceOnArc(ball), ~ball.ab));
}

BALLPISTON_HOST_DEVICE double Abscissa(const FlightProgram& k, const FlightBall& ball) {
  const double along = std::fma(-ball.c, ball.e, std::fma(ball.s, ball.h, -k.half_height));
  return Negated(along, ball.a) + Negated(PlaceOnArc(ball), ball.a ^ ball.ab);
}

BALLPISTON_HOST_DEVICE double PhaseAfter(const FlightLane& lane, double path) {
  return std::fma(lane.ratio, path, lane.phase);
}

// PistonMayBeNear, if the program looks first, and MayHaveMet.
BALLPISTON_HOST_DEVICE bool MayHaveMet(const FlightProgram& k, const FlightLane& lane,
                                       const FlightBall& from, const FlightBall& to) {
  const double before = PhaseAfter(lane, from.path), after = PhaseAfter(lane, to.path);
  const double turns = std::floor(after), last = std::floor(before);
  const bool turned = turns > last;
  const double phase0 = before - last;
  if (k.looks_first != 0 && !turned) {
    const double rest = (turns + 1.0) - after;
    const double nearest = phase0 < rest ? phase0 : rest;
    if (!(nearest < k.phase_at_tip)) return false;
  }
  const double x0 = Abscissa(k, from) - k.left, x1 = Abscissa(k, to) - k.left;
  const double gain = x1 - x0;
  const double phase1 = after - turns, way = after - before;
  const double rest1 = 1.0 - phase1;
  const double distance = (phase1 < rest1 ? phase1 : rest1) * k.period;
  const double at_first = std::fma(gain, 1.0 - phase0, x0 * way);
  const double at_last = std::fma(-gain, phase1, x1 * way);
  return x1 > distance || (turned && (at_first > 0.0 || at_last > 0.0));
}

// ---- a burst ----

// Flies from flight `first` to the end of the burst. If something happens in a flight, returns it;
// `lane` is then as before this flight, `flight` is its number, and `path_after` the path after it.
BALLPISTON_HOST_DEVICE FlightNews FlyBurst(const FlightProgram& k, FlightLane& lane, uint32_t first,
                                           uint32_t& flight, double& path_after) {
  FlightBall ball = lane.ball;
  uint32_t in_reach = lane.in_reach;
  for (flight = first; flight < k.flights; ++flight) {
    const FlightBall from = ball;
    const double square = Fly(k, ball);
    const uint32_t reaches = InReach(k, ball);
    const bool escaped = IsSet(UpperWord(square + k.missed_by_rounding));
    if (escaped || (IsSet(in_reach | reaches) && MayHaveMet(k, lane, from, ball))) {
      lane.ball = from;
      path_after = ball.path;
      return escaped ? FlightNews::kEscaped : FlightNews::kMayHaveMet;
    }
    in_reach = reaches;
  }
  const double phase = PhaseAfter(lane, ball.path);
  lane.phase = phase - std::floor(phase);
  lane.path_before += ball.path;
  lane.ball = ball;
  lane.ball.path = 0.0;
  lane.in_reach = in_reach;
  ++lane.bursts;
  return FlightNews::kNone;
}

// A burst, and whether the orbit is overdue after it.
BALLPISTON_HOST_DEVICE FlightNews FlyWholeBurst(const FlightProgram& k, FlightLane& lane,
                                                uint32_t& flight, double& path_after) {
  const FlightNews news = FlyBurst(k, lane, 0, flight, path_after);
  if (news != FlightNews::kNone) return news;
  flight = 0;
  path_after = 0.0;
  return lane.path_before > lane.longest_path ? FlightNews::kOverdue : FlightNews::kNone;
}

// Up to `bursts` bursts of a lane. A lane without an orbit takes one by `bool next(FlightLane&)`,
// which is false if there is none. When something happens, `report(const FlightReport&)` gets it,
// and the lane has no orbit.
template <typename Next, typename Report>
BALLPISTON_HOST_DEVICE void FlyLane(const FlightProgram& k, uint32_t bursts, FlightLane& lane,
                                    const Next& next, const Report& report) {
  for (uint32_t burst = 0; burst < bursts; ++burst) {
    if (lane.orbit == kNoOrbit && !next(lane)) return;
    uint32_t flight = 0;
    double path_after = 0;
    const FlightNews news = FlyWholeBurst(k, lane, flight, path_after);
    if (news == FlightNews::kNone) continue;
    report(FlightReport{lane, path_after, flight, news});
    lane.orbit = kNoOrbit;
  }
}

}  // namespace ballpiston
