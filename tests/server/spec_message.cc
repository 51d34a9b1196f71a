#include "tests/server/spec_message.h"

#include "core/ensemble/experiment_kind.h"
#include "core/gas/gas_shape.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/util/time_util.h"
#include "server/convert/spec.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

void Fill(const ballpiston::Grid& grid, v1::Grid& message) {
  for (const Parameter* parameter : kParameters) {
    if (parameter == &kCells) continue;
    const auto* field = v1::Grid::descriptor()->FindFieldByName(std::string(parameter->name));
    for (const double value : grid[*parameter]) {
      message.GetReflection()->AddDouble(&message, field, value);
    }
  }
  for (const double code : grid[kCells]) message.add_cells(Text(ShapeOf(code)));
}

void Fill(const Target& target, v1::Target& message) {
  if (target.samples) message.set_samples(*target.samples);
  if (target.collisions) message.set_collisions(*target.collisions);
  if (target.tolerance) message.set_tolerance(*target.tolerance);
  if (target.budget_seconds) {  // below 10^6 s, so it fits into an int64 of nanoseconds
    *message.mutable_budget() = google::protobuf::util::TimeUtil::NanosecondsToDuration(
        std::llround(1e9 * *target.budget_seconds));
  }
  message.set_estimate(target.estimate);
}

}  // namespace

v1::EnsembleSpec SpecMessage(const EnsembleSpec& spec) {
  v1::EnsembleSpec message;
  if (spec.experiment != nullptr) {
    message.set_experiment(static_cast<v1::EnsembleSpec::Experiment>(spec.experiment->number));
  }
  Fill(spec.grid, *message.mutable_grid());
  Fill(spec.target, *message.mutable_target());
  message.set_seed(spec.seed);
  message.set_model(ModelMessage(spec.model));
  message.set_precision(spec.precision == Precision::kSingle ? v1::EnsembleSpec::SINGLE
                                                             : v1::EnsembleSpec::DOUBLE);
  message.set_verify(spec.verify);
  return message;
}

}  // namespace ballpiston::server
