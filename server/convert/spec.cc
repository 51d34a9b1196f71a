#include "server/convert/spec.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/engine_version.h"
#include "core/model_choice/ladder.h"
#include "google/protobuf/message.h"
#include "google/protobuf/unknown_field_set.h"
#include "server/convert/deterministic_bytes.h"

namespace ballpiston::server {
namespace {

using Violations = std::vector<FieldViolation>;

// A message of a few bytes each may hold millions of them; so many that are told say it all.
constexpr int kMaxUnknownFields = 100;

// A number of an enumeration that has no name here.
void AddUnknownNumber(const char* field, int number, Violations& violations) {
  violations.push_back(
      {field, absl::StrCat(number,
                           " is not a value this server knows; is it older than its "
                           "client?")});
}

Experiment ExperimentOf(v1::EnsembleSpec::Experiment message, Violations& violations) {
  switch (message) {
    case v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED:
      return Experiment::kUnspecified;
    case v1::EnsembleSpec::EQUILIBRIUM:
      return Experiment::kEquilibrium;
    case v1::EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME:
      return Experiment::kConditionalMeanFreeTime;
    case v1::EnsembleSpec::FIRST_HIT:
      return Experiment::kFirstHit;
    case v1::EnsembleSpec::ENERGY_RELAXATION:
      return Experiment::kEnergyRelaxation;
    case v1::EnsembleSpec::MARKOV_PROPERTY:
      return Experiment::kMarkovProperty;
    default:
      AddUnknownNumber("spec.experiment", message, violations);
      return Experiment::kUnspecified;
  }
}

Model ModelOf(v1::EnsembleSpec::Model message, Violations& violations) {
  switch (message) {
    case v1::EnsembleSpec::MODEL_UNSPECIFIED:
    case v1::EnsembleSpec::AUTO:
      return Model::kAuto;
    case v1::EnsembleSpec::CLOSED_FORM:
      return Model::kClosedForm;
    case v1::EnsembleSpec::SPECTRUM:
      return Model::kSpectrum;
    case v1::EnsembleSpec::MARKOV:
      return Model::kMarkov;
    case v1::EnsembleSpec::BILLIARD:
      return Model::kBilliard;
    case v1::EnsembleSpec::BILLIARD_REFERENCE:
      return Model::kBilliardReference;
    default:
      AddUnknownNumber("spec.model", message, violations);
      return Model::kAuto;
  }
}

Precision PrecisionOf(v1::EnsembleSpec::Precision message, Violations& violations) {
  switch (message) {
    case v1::EnsembleSpec::PRECISION_UNSPECIFIED:
    case v1::EnsembleSpec::DOUBLE:
      return Precision::kDouble;
    case v1::EnsembleSpec::SINGLE:
      return Precision::kSingle;
    default:
      AddUnknownNumber("spec.precision", message, violations);
      return Precision::kDouble;
  }
}

Grid GridOf(const v1::Grid& message) {
  Grid grid;
  grid.rho.assign(message.rho().begin(), message.rho().end());
  grid.delta.assign(message.delta().begin(), message.delta().end());
  grid.epsilon.assign(message.epsilon().begin(), message.epsilon().end());
  grid.exponent.assign(message.exponent().begin(), message.exponent().end());
  grid.cells.assign(message.cells().begin(), message.cells().end());
  return grid;
}

double Seconds(const google::protobuf::Duration& duration) {
  return static_cast<double>(duration.seconds()) + 1e-9 * duration.nanos();
}

Target TargetOf(const v1::Target& message) {
  Target target;
  switch (message.kind_case()) {
    case v1::Target::kSamples:
      target.samples = message.samples();
      break;
    case v1::Target::kCollisions:
      target.collisions = message.collisions();
      break;
    case v1::Target::kTolerance:
      target.tolerance = message.tolerance();
      break;
    case v1::Target::KIND_NOT_SET:
      break;
  }
  if (message.has_budget()) target.budget_seconds = Seconds(message.budget());
  return target;
}

void AddUnknownFields(const char* path, const google::protobuf::Message& message,
                      Violations& violations) {
  const auto& unknown = message.GetReflection()->GetUnknownFields(message);
  for (int i = 0; i < std::min(unknown.field_count(), kMaxUnknownFields); ++i) {
    violations.push_back({path, absl::StrCat("field number ", unknown.field(i).number(),
                                             " is not one this server knows; is it older than "
                                             "its client?")});
  }
}

// The core's own findings, except on fields that did not even get there.
void AddCoreViolations(const EnsembleSpec& spec, Violations& violations) {
  const size_t known = violations.size();
  Violations found = ballpiston::Violations(spec);
  if (found.empty()) found = ToleranceViolations(spec);
  for (FieldViolation& violation : found) {
    violation.field = absl::StrCat("spec.", violation.field);
    bool repeated = false;
    for (size_t i = 0; i < known; ++i) repeated |= violations[i].field == violation.field;
    if (!repeated) violations.push_back(std::move(violation));
  }
}

v1::EnsembleSpec::Experiment ExperimentMessage(Experiment experiment) {
  switch (experiment) {
    case Experiment::kUnspecified:
      return v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED;
    case Experiment::kEquilibrium:
      return v1::EnsembleSpec::EQUILIBRIUM;
    case Experiment::kConditionalMeanFreeTime:
      return v1::EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME;
    case Experiment::kFirstHit:
      return v1::EnsembleSpec::FIRST_HIT;
    case Experiment::kEnergyRelaxation:
      return v1::EnsembleSpec::ENERGY_RELAXATION;
    case Experiment::kMarkovProperty:
      return v1::EnsembleSpec::MARKOV_PROPERTY;
  }
  return v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED;
}

v1::Grid GridMessage(const Grid& grid) {
  v1::Grid message;
  message.mutable_rho()->Assign(grid.rho.begin(), grid.rho.end());
  message.mutable_delta()->Assign(grid.delta.begin(), grid.delta.end());
  message.mutable_epsilon()->Assign(grid.epsilon.begin(), grid.epsilon.end());
  message.mutable_exponent()->Assign(grid.exponent.begin(), grid.exponent.end());
  message.mutable_cells()->Assign(grid.cells.begin(), grid.cells.end());
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
  return message;
}

}  // namespace

CheckedSpec CheckSpec(const v1::EnsembleSpec& message) {
  CheckedSpec checked;
  AddUnknownFields("spec", message, checked.violations);
  AddUnknownFields("spec.grid", message.grid(), checked.violations);
  AddUnknownFields("spec.target", message.target(), checked.violations);
  checked.spec.experiment = ExperimentOf(message.experiment(), checked.violations);
  checked.spec.grid = GridOf(message.grid());
  checked.spec.target = TargetOf(message.target());
  checked.spec.seed = message.seed();
  checked.spec.model = ModelOf(message.model(), checked.violations);
  checked.spec.precision = PrecisionOf(message.precision(), checked.violations);
  checked.spec.verify = message.verify();
  AddCoreViolations(checked.spec, checked.violations);
  return checked;
}

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

v1::PointParameters ParametersMessage(const PointParameters& parameters) {
  v1::PointParameters message;
  message.set_rho(parameters.rho);
  message.set_delta(parameters.delta);
  if (parameters.epsilon) message.set_epsilon(*parameters.epsilon);
  if (parameters.exponent) message.set_exponent(*parameters.exponent);
  return message;
}

v1::EnsembleSpec::Model ModelMessage(Model model) {
  switch (model) {
    case Model::kAuto:
      return v1::EnsembleSpec::AUTO;
    case Model::kClosedForm:
      return v1::EnsembleSpec::CLOSED_FORM;
    case Model::kSpectrum:
      return v1::EnsembleSpec::SPECTRUM;
    case Model::kMarkov:
      return v1::EnsembleSpec::MARKOV;
    case Model::kBilliard:
      return v1::EnsembleSpec::BILLIARD;
    case Model::kBilliardReference:
      return v1::EnsembleSpec::BILLIARD_REFERENCE;
  }
  return v1::EnsembleSpec::MODEL_UNSPECIFIED;
}

std::string SpecBytes(const v1::EnsembleSpec& message) { return DeterministicBytes(message); }

absl::StatusOr<v1::EnsembleSpec> SpecFromBytes(const std::string& bytes) {
  v1::EnsembleSpec message;
  if (message.ParseFromString(bytes)) return message;
  return absl::DataLossError("the stored specification cannot be read");
}

std::string EngineVersion() { return std::string(kEngineVersion); }

}  // namespace ballpiston::server
