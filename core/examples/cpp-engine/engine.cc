// Runs the engine in this process, without a server: the mean time until ball and piston meet, by
// the billiard, and the same number by the closed form.
#include <ballpiston/core/ensemble/point_experiment.h>
#include <ballpiston/core/ensemble/point_fold.h>
#include <ballpiston/core/experiment/all_experiments.h>

#include <iostream>

int main() {
  using namespace ballpiston;
  EnsembleSpec spec;
  spec.experiment = &kConditionalMeanFreeTime;
  spec.grid[kRho] = {0.5296};
  spec.grid[kDelta] = {0.2, 0.1};
  spec.grid[kEpsilon] = {0.125};
  spec.target.samples = 20'000;
  spec.model = Model::kBilliard;
  spec.seed = 7;
  for (const FieldViolation& violation : Violations(spec)) {
    std::cerr << violation.field << ": " << violation.description << '\n';
    return 1;
  }
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const auto experiment = PointExperiment::Create(spec, i);
    const Estimate first = experiment->Summarize(FoldPoint(*experiment)).estimates.front();
    std::cout << "delta " << experiment->parameters()[kDelta] << ": " << first.name << " "
              << first.value;
    // Too few samples have no standard error, and some estimates no exact value.
    if (first.standard_error) std::cout << " +- " << *first.standard_error;
    if (first.exact) std::cout << ", exactly " << *first.exact;
    std::cout << '\n';
  }
}
