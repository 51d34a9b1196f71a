// Chooses the model that answers a point, with the rates of this server and the pilots that it has
// run.
//
// The server measures rates when they are first needed (about 0.3 s) and keeps them until it stops.
// The measurement does not use the disk, which may hang. The rates of points without samples
// include all work of the thread that serves them. The store keeps pilots. If a pilot cannot be
// read, it is run again; if it cannot be stored, its result is still used. Thread-safe.
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "core/model_choice/ladder.h"
#include "server/compute/point_opener.h"
#include "server/mutex.h"
#include "server/store/store.h"

namespace ballpiston::server {

// The sampling rates of this machine: measures the jump process and the engines on the calling
// thread, in about 0.3 s. The costs of points without samples stay 0: the ladder measures them,
// because they include the server's own work.
MachineRates MeasureSamplingRates();  // machine_rates.cc

class ModelLadder : public PointOpener {
 public:
  // The store must outlive the ladder. A question that needs more bytes than `memory` is a
  // violation.
  ModelLadder(Store& store, int workers, double memory = std::numeric_limits<double>::infinity());

  // The core's experiment, by the model that was asked for or chosen.
  OpenedPoint Open(const EnsembleSpec& spec, size_t index) override;
  double MemoryOf(const EnsembleSpec& spec, size_t index, int threads) override;
  void KeepPilot(const PilotPlace& place, const Pilot& pilot) override;

  // Runs only the measurement of the rates. `planned` has the pilots of earlier ladders; this
  // ladder does not count their work again.
  Ladder LadderOf(const EnsembleSpec& spec, const PointParameters& point,
                  const std::set<PilotPlace>& planned = {});

  const Machine& machine();

  // What this machine cannot do (MachineViolations). Measures the rates if the spec has a budget.
  std::vector<FieldViolation> ViolationsHere(const EnsembleSpec& spec);

 private:
  void Measure();
  Machine Unmeasured() const;            // without rates
  void Serve(const EnsembleSpec& spec);  // all the work for a point without samples
  std::optional<Pilot> Known(const PilotPlace& place);

  Store& store_;
  const int workers_;
  const double memory_;
  std::once_flag measured_;
  Machine machine_;

  Mutex mutex_;
  std::map<PilotPlace, Pilot> pilots_ ABSL_GUARDED_BY(mutex_);  // a cache of the store
};

}  // namespace ballpiston::server
