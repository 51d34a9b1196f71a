// Traces: one orbit of the pair or of a periodic gas, event by event, by the reference engines.
//
// The whole gas has one coordinate system: cell (column, row) is centred at (column, row). A body
// keeps the coordinates of its cell or edge, so positions do not jump at the periodic boundary. The
// piston at the left edge of column c is near x = c - 1/2, the piston at the lower edge of row r
// near y = r - 1/2. A pair is in the cell (0, 0), its piston at (q3, 0).
//
// The free time of an event is the time since the last event of its kind with the same ball and
// piston, on the same side of the ball: the paper's tau_bp (eq. bpfreetime), and likewise for the
// walls. If the trace is much longer than the mean free time of a kind, the mean over the events of
// that kind is the mean free time; for exchanges in a gas it is 1/exchange rate
// (gas_exchange_rate.h). Shorter traces lose long free times.
//
// Properties, each with a test of its name:
//   1. PairTraceMatchesTheReferenceFlow.
//   2. EventsAreThoseOfTheReferenceAndEndStraightFlights. They conserve energy. Free times count
//      from the last event of the same kind and bodies.
//
// Units: lengths are cells, masses 1. One object is one orbit. Not thread-safe.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/geometry/pair_state.h"

namespace ballpiston {

struct TracedBody {
  Eigen::Vector2d position = {0, 0};  // of a piston: its middle
  Eigen::Vector2d velocity = {0, 0};
  double energy = 0;
};

// A body's part in an event.
struct TracedChange {
  int64_t index = 0;  // of the ball, or of the piston
  double energy_before = 0;
  TracedBody after;
};

struct TraceEvent {
  EventKind kind = EventKind::kEscape;
  double time = 0;                       // since the start
  std::optional<double> free_time = {};  // empty at the first event of its kind with these bodies
  std::optional<TracedChange> ball = {};
  std::optional<TracedChange> piston = {};
};

class Trace {
 public:
  virtual ~Trace() = default;

  // All bodies at the start. To be called before the first call of Next.
  virtual std::vector<TracedBody> Balls() const = 0;
  virtual std::vector<TracedBody> Pistons() const = 0;

  // The next event; empty if all bodies are at rest. A ball that escapes, which is a defect, has no
  // later event: in the gas it stops in the middle of its cell, and for the pair the escape is the
  // last event.
  virtual std::optional<TraceEvent> Next() = 0;
};

// A trace of the pair from this start, a state inside its phase space.
std::unique_ptr<Trace> TracePair(const PairGeometry& geometry, const PairState& start);
// A trace of the gas, which must be periodic.
std::unique_ptr<Trace> TraceGas(const GasGeometry& geometry, const GasState& start);

}  // namespace ballpiston
