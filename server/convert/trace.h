// Converts the core's trace of one orbit to the messages of TraceService.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "absl/status/statusor.h"
#include "ballpiston/v1/trace.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/trace.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston::server {

// So many events take half a second of one core for a pair and a second for a gas, and some 200 MB
// of messages.
inline constexpr int64_t kMaxTracedEvents = 1'000'000;
inline constexpr int64_t kMaxTracedCells = 1'000;
inline constexpr int kEventsOfMessage = 256;

// The messages of one trace. Not thread-safe.
class TraceMessages {
 public:
  // Draws the orbit's start. INVALID_ARGUMENT with every violation.
  static absl::StatusOr<TraceMessages> Create(const v1::TraceOrbitRequest& request);

  // Fills the message with the start (in the first message) or the next events, at most
  // kEventsOfMessage. False after the last event.
  bool FillNext(v1::TraceOrbitResponse& message);

 private:
  static TraceMessages OfPair(const v1::TraceOrbitRequest& request, const PairGeometry& pair);
  static TraceMessages OfGas(const v1::TraceOrbitRequest& request, const GasGeometry& gas);
  TraceMessages(std::unique_ptr<Trace> trace, const v1::TraceStart& start, int64_t events)
      : trace_(std::move(trace)), start_(start), events_left_(events) {}

  std::unique_ptr<Trace> trace_;
  std::optional<v1::TraceStart> start_;  // until it is sent
  int64_t events_left_;
};

}  // namespace ballpiston::server
