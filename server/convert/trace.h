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
  TraceMessages(std::unique_ptr<Trace> trace, v1::TraceStart start, int64_t events)
      : trace_(std::move(trace)), start_(std::move(start)), events_left_(events) {}

  // Fills the message with the start (in the first message) and the next events, at most
  // kEventsOfMessage.
  void FillNext(v1::TraceOrbitResponse& message);
  bool HasEnded() const { return events_left_ == 0; }

 private:
  std::unique_ptr<Trace> trace_;
  std::optional<v1::TraceStart> start_;  // until it is sent
  int64_t events_left_;
};

// A valid request. Immutable.
class TraceQuestion {
 public:
  // INVALID_ARGUMENT with every violation.
  static absl::StatusOr<TraceQuestion> Create(const v1::TraceOrbitRequest& request);

  // Upper bound of the memory of a trace and of its messages.
  int64_t Bytes() const;

  TraceMessages Start() const;

 private:
  TraceQuestion(const v1::TraceOrbitRequest& request, const PairGeometry& pair,
                const std::optional<GasGeometry>& gas)
      : request_(request), pair_(pair), gas_(gas) {}

  std::unique_ptr<Trace> StartTrace() const;
  v1::TraceStart StartMessage(const Trace& trace) const;
  double Temperature() const { return request_.has_temperature() ? request_.temperature() : 1; }

  v1::TraceOrbitRequest request_;
  PairGeometry pair_;
  std::optional<GasGeometry> gas_;
};

}  // namespace ballpiston::server
