// Opens the points of a run: chooses the model that answers, and makes the point's experiment.
#pragma once

#include <cstddef>
#include <memory>

#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_experiment.h"

namespace ballpiston::server {

// Thread-safe. Must not wait for another point.
class PointOpener {
 public:
  virtual ~PointOpener() = default;

  // May throw.
  virtual std::unique_ptr<const PointExperiment> Open(const EnsembleSpec& spec, size_t index) = 0;

  // Bytes, upper bound, while so many threads compute the point.
  virtual double MemoryOf(const EnsembleSpec&, size_t /*index*/, int /*threads*/) { return 0; }
};

}  // namespace ballpiston::server
