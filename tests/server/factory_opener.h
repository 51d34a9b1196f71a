// Opens points with a given experiment, without a choice.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include "server/compute/point_opener.h"

namespace ballpiston::server {

// Makes a point's experiment. May throw.
using ExperimentFactory =
    std::function<std::unique_ptr<const PointExperiment>(const EnsembleSpec&, size_t index)>;

class FactoryOpener : public PointOpener {
 public:
  explicit FactoryOpener(ExperimentFactory factory) : factory_(std::move(factory)) {}

  std::unique_ptr<const PointExperiment> Open(const EnsembleSpec& spec, size_t index) override {
    return factory_(spec, index);
  }

 private:
  const ExperimentFactory factory_;
};

}  // namespace ballpiston::server
