// Opens the points of a run: chooses the model that answers, and makes the point's experiment.
#pragma once

#include <cstddef>
#include <memory>
#include <variant>

#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_experiment.h"
#include "core/model_choice/limit_error.h"

namespace ballpiston::server {

// The experiment, or the pilot without which the model cannot be chosen.
using OpenedPoint = std::variant<std::unique_ptr<const PointExperiment>, PilotPlace>;

// Thread-safe. Must not wait for another point or pilot.
class PointOpener {
 public:
  virtual ~PointOpener() = default;

  // May throw.
  virtual OpenedPoint Open(const EnsembleSpec& spec, size_t index) = 0;

  // Bytes, upper bound, while so many threads compute the point or its pilot.
  virtual double MemoryOf(const EnsembleSpec&, size_t /*index*/, int /*threads*/) { return 0; }

  // The billiard run of a pilot that Open named. May throw.
  virtual std::unique_ptr<const PointExperiment> OpenPilot(const PilotPlace& place) {
    return PilotExperiment(place);
  }

  // A pilot that Open named has this result. From now on Open knows it.
  virtual void KeepPilot(const PilotPlace& place, const Pilot& pilot) = 0;
};

}  // namespace ballpiston::server
