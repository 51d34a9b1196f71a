#include "tests/server/spec_message.h"

#include "core/ensemble/experiment_kind.h"
#include "core/gas/gas_shape.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/message.h"
#include "server/convert/spec.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

v1::EnsembleSpec::Experiment ExperimentMessage(const ExperimentKind* experiment) {
  return static_cast<v1::EnsembleSpec::Experiment>(experiment == nullptr ? 0 : experiment->number);
}

v1::Grid GridMessage(const ballpiston::Grid& grid) {
  v1::Grid message;
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  for (const Parameter* parameter : kParameters) {
    if (parameter == &kCells) continue;
    const auto* field = v1::Grid::descriptor()->FindFieldByName(std::string(parameter->name));
    for (const double value : grid[*parameter]) reflection.AddDouble(&message, field, value);
  }
  for (const double code : grid[kCells]) message.add_cells(Text(ShapeOf(code)));
  return message;
}

v1::Target TargetMessage(const Target& target) {
  v1::Target message;
  if (target.samples) message.set_samples(*target.samples);
  if (target.collisions) message.set_collisions(*target.collisions);
  if (target.tolerance) message.set_tolerance(*target.tolerance);
  if (target.budget_seconds) {
    const int64_t nanos = std::llround(1e9 * *target.budget_seconds);  // below 10^6 s: it fits
    message.mutable_budget()->set_seconds(nanos / 1'000'000'000);
    message.mutable_budget()->set_nanos(static_cast<int32_t>(nanos % 1'000'000'000));
  }
  message.set_estimate(target.estimate);
  return message;
}

}  // namespace

v1::EnsembleSpec SpecMessage(const EnsembleSpec& spec) {
  v1::EnsembleSpec message;
  message.set_experiment(ExperimentMessage(spec.experiment));
  *message.mutable_grid() = GridMessage(spec.grid);
  *message.mutable_target() = TargetMessage(spec.target);
  message.set_seed(spec.seed);
  message.set_model(ModelMessage(spec.model));
  message.set_precision(spec.precision == Precision::kSingle ? v1::EnsembleSpec::SINGLE
                                                             : v1::EnsembleSpec::DOUBLE);
  message.set_verify(spec.verify);
  return message;
}

}  // namespace ballpiston::server
