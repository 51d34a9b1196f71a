// Chooses the model that answers a point, with the rates of this server.
//
// The server measures rates when they are first needed (about 0.3 s) and keeps them until it stops.
// The measurement does not use the disk, which may hang. The rates of points without samples
// include all work of the thread that serves them. Thread-safe.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "core/model_choice/ladder.h"
#include "server/compute/point_opener.h"

namespace ballpiston::server {

// The sampling rates of this machine: measures the jump process and the engines on the calling
// thread, in about 0.3 s. The costs of points without samples stay 0: the ladder measures them,
// because they include the server's own work.
MachineRates MeasureSamplingRates();  // machine_rates.cc

class ModelLadder : public PointOpener {
 public:
  // A question that needs more bytes than `memory` is a violation.
  explicit ModelLadder(int workers, double memory = std::numeric_limits<double>::infinity())
      : workers_(workers), memory_(memory) {}

  // The core's experiment, by the model that was asked for or chosen.
  std::unique_ptr<const PointExperiment> Open(const EnsembleSpec& spec, size_t index) override;
  double MemoryOf(const EnsembleSpec& spec, size_t index, int threads) override;

  const Machine& machine();

  // What this machine cannot do (MachineViolations). Measures the rates if the spec has a budget.
  std::vector<FieldViolation> ViolationsHere(const EnsembleSpec& spec);

 private:
  void Measure();
  Machine Unmeasured() const;            // without rates
  void Serve(const EnsembleSpec& spec);  // all the work for a point without samples

  const int workers_;
  const double memory_;
  std::once_flag measured_;
  Machine machine_;
};

}  // namespace ballpiston::server
