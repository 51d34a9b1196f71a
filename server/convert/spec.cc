#include "server/convert/spec.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "core/ensemble/experiment_kind.h"
#include "core/model_choice/ladder.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/message.h"
#include "google/protobuf/reflection.h"
#include "google/protobuf/unknown_field_set.h"
#include "server/convert/deterministic_bytes.h"

namespace ballpiston::server {
namespace {

using Violations = std::vector<FieldViolation>;

// A message can hold millions of wrong fields of a few bytes each; at most this many are listed.
constexpr int kMostListed = 100;

// Adds a violation for an unknown number of an enumeration.
void AddUnknownNumber(const char* field, int number, Violations& violations) {
  violations.push_back(
      {field, absl::StrCat(number,
                           " is not a value this server knows; is it older than its "
                           "client?")});
}

const ExperimentKind* ExperimentOf(v1::EnsembleSpec::Experiment message, Violations& violations) {
  const ExperimentKind* found = FindExperiment(static_cast<uint64_t>(message));
  if (found == nullptr && message != v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED) {
    AddUnknownNumber("spec.experiment", message, violations);
  }
  return found;
}

constexpr std::pair<v1::EnsembleSpec::Model, Model> kModels[] = {
    {v1::EnsembleSpec::AUTO, Model::kAuto},
    {v1::EnsembleSpec::CLOSED_FORM, Model::kClosedForm},
    {v1::EnsembleSpec::SPECTRUM, Model::kSpectrum},
    {v1::EnsembleSpec::MARKOV, Model::kMarkov},
    {v1::EnsembleSpec::BILLIARD, Model::kBilliard},
    {v1::EnsembleSpec::BILLIARD_REFERENCE, Model::kBilliardReference}};

Model ModelOf(v1::EnsembleSpec::Model message, Violations& violations) {
  const auto found =
      std::ranges::find(kModels, message, &std::pair<v1::EnsembleSpec::Model, Model>::first);
  if (found != std::end(kModels)) return found->second;
  if (message != v1::EnsembleSpec::MODEL_UNSPECIFIED) {
    AddUnknownNumber("spec.model", message, violations);
  }
  return Model::kAuto;
}

Precision PrecisionOf(v1::EnsembleSpec::Precision message, Violations& violations) {
  if (message == v1::EnsembleSpec::SINGLE) return Precision::kSingle;
  if (message != v1::EnsembleSpec::DOUBLE && message != v1::EnsembleSpec::PRECISION_UNSPECIFIED) {
    AddUnknownNumber("spec.precision", message, violations);
  }
  return Precision::kDouble;
}

// A list of the grid, or a parameter of a point, by the parameter's name.
const google::protobuf::FieldDescriptor* FieldOf(const google::protobuf::Message& message,
                                                 const Parameter& parameter) {
  return message.GetDescriptor()->FindFieldByName(std::string(parameter.name));
}

// The form in which an error shows a text of the user that is not known. It leaves the names of
// shapes and estimates as they are.
std::string Shown(absl::string_view text) {
  constexpr size_t kLongest = 100;
  const std::string shown = absl::CEscape(text.substr(0, kLongest));
  return text.size() > kLongest ? absl::StrCat(shown, "...") : shown;
}

// The code of the shape; NaN, which is the code of no shape, and a violation if there is none.
double CellsOf(const std::string& text, int index, Violations& violations) {
  const absl::StatusOr<GasShape> shape = ShapeOfText(text);
  if (shape.ok()) return CodeOf(*shape);
  violations.push_back(
      {absl::StrCat("spec.grid.cells[", index, "]"), std::string(shape.status().message())});
  return std::numeric_limits<double>::quiet_NaN();
}

void NameOfParameter(std::string* out, const Parameter* parameter) {
  absl::StrAppend(out, parameter->name);
}

// A list with more texts than a grid has points is not read: its length is a violation.
std::vector<double> CodesOf(const v1::Grid& message, Violations& violations) {
  const auto size = static_cast<size_t>(message.cells_size());
  std::vector<double> codes(size, std::numeric_limits<double>::quiet_NaN());
  if (message.cells_size() > kMaxPoints) return codes;
  for (size_t i = 0; i < size; ++i) {
    const int index = static_cast<int>(i);
    codes[i] = CellsOf(message.cells(index), index, violations);
  }
  return codes;
}

// Marks the lists that `table` names.
void MakeColumns(const v1::Grid& message, Grid& grid, Violations& violations) {
  for (int i = 0; i < message.table_size(); ++i) {
    const auto found = std::ranges::find(kParameters, message.table(i), &Parameter::name);
    const bool is_new = found != kParameters.end() && !grid.IsColumn(**found);
    if (is_new) {
      grid.MakeColumn(**found);
      continue;
    }
    violations.push_back(
        {absl::StrCat("spec.grid.table[", i, "]"),
         absl::StrCat("is ", Shown(message.table(i)), "; permitted: ",
                      absl::StrJoin(kParameters, ", ", NameOfParameter), ", each once")});
    if (i >= kMostListed) return;
  }
}

Grid GridOf(const v1::Grid& message, Violations& violations) {
  Grid grid;
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  for (const Parameter* parameter : kParameters) {
    if (parameter == &kCells) continue;
    const auto* field = FieldOf(message, *parameter);
    std::vector<double>& list = grid[*parameter];
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      list.push_back(reflection.GetRepeatedDouble(message, field, i));
    }
  }
  grid[kCells] = CodesOf(message, violations);
  MakeColumns(message, grid, violations);
  return grid;
}

double Seconds(const google::protobuf::Duration& duration) {
  return static_cast<double>(duration.seconds()) + duration.nanos() / 1e9;
}

Target TargetOf(const v1::Target& message) {
  Target target;
  if (message.has_samples()) target.samples = message.samples();
  if (message.has_collisions()) target.collisions = message.collisions();
  if (message.has_tolerance()) target.tolerance = message.tolerance();
  if (message.has_budget()) target.budget_seconds = Seconds(message.budget());
  target.estimate = Shown(message.estimate());
  return target;
}

// In a negative duration both parts are negative; the core rejects a negative budget.
void CheckNanos(const google::protobuf::Duration& budget, Violations& violations) {
  constexpr int32_t kMost = 999'999'999;
  const int32_t nanos = budget.nanos();
  if (nanos <= kMost && (nanos >= 0 || budget.seconds() <= 0)) return;
  violations.push_back(
      {"spec.target.budget.nanos", absl::StrCat("is ", nanos, "; permitted: 0 to ", kMost)});
}

// -0 + 0.0 is 0, and every other number stays.
void DropSignsOfZeros(v1::EnsembleSpec& message) {
  if (message.target().has_tolerance()) {
    message.mutable_target()->set_tolerance(message.target().tolerance() + 0.0);
  }
  if (!message.has_grid()) return;
  v1::Grid& grid = *message.mutable_grid();
  for (const Parameter* parameter : kParameters) {
    if (parameter == &kCells) continue;
    const auto list =
        grid.GetReflection()->GetMutableRepeatedFieldRef<double>(&grid, FieldOf(grid, *parameter));
    for (int i = 0; i < list.size(); ++i) list.Set(i, list.Get(i) + 0.0);
  }
}

Violations CoreViolations(const EnsembleSpec& spec) {
  Violations found = ballpiston::Violations(spec);
  return found.empty() ? AnswerViolations(spec) : found;
}

}  // namespace

void AddUnknownFields(const char* path, const google::protobuf::Message& message,
                      std::vector<FieldViolation>& violations) {
  const auto& unknown = message.GetReflection()->GetUnknownFields(message);
  for (int i = 0; i < std::min(unknown.field_count(), kMostListed); ++i) {
    violations.push_back({path, absl::StrCat("unknown field number ", unknown.field(i).number(),
                                             "; the server may be older than the client")});
  }
}

CheckedSpec CheckSpec(const v1::EnsembleSpec& message) {
  CheckedSpec checked;
  AddUnknownFields("spec", message, checked.violations);
  AddUnknownFields("spec.grid", message.grid(), checked.violations);
  AddUnknownFields("spec.target", message.target(), checked.violations);
  checked.spec.experiment = ExperimentOf(message.experiment(), checked.violations);
  checked.spec.grid = GridOf(message.grid(), checked.violations);
  CheckNanos(message.target().budget(), checked.violations);
  checked.spec.target = TargetOf(message.target());
  checked.spec.seed = message.seed();
  checked.spec.model = ModelOf(message.model(), checked.violations);
  checked.spec.precision = PrecisionOf(message.precision(), checked.violations);
  checked.spec.verify = message.verify();
  AddViolations(CoreViolations(checked.spec), checked);
  return checked;
}

// Fields that already have a violation get no other one.
void AddViolations(std::vector<FieldViolation> found, CheckedSpec& checked) {
  std::set<std::string> known;
  for (const FieldViolation& violation : checked.violations) known.insert(violation.field);
  for (FieldViolation& violation : found) {
    violation.field = absl::StrCat("spec.", violation.field);
    if (!known.contains(violation.field)) checked.violations.push_back(std::move(violation));
  }
}

void Normalize(v1::EnsembleSpec& message) {
  DropSignsOfZeros(message);
  for (std::string& cells : *message.mutable_grid()->mutable_cells()) {  // 03x2 is 3x2
    if (const auto shape = ParseGasShape(cells); shape.ok()) cells = Text(*shape);
  }
  const ExperimentKind* const experiment =
      FindExperiment(static_cast<uint64_t>(message.experiment()));
  if (experiment == nullptr) return;
  for (const ParameterUse& use : experiment->parameters) {
    if (!use.default_value) continue;
    v1::Grid& grid = *message.mutable_grid();
    const auto* field = FieldOf(grid, *use.parameter);
    if (grid.GetReflection()->FieldSize(grid, field) > 0) continue;
    grid.GetReflection()->AddDouble(&grid, field, *use.default_value);
  }
}

absl::StatusOr<GasShape> ShapeOfText(const std::string& text) {
  const absl::StatusOr<GasShape> shape = ParseGasShape(text);
  return shape.ok() ? shape : ParseGasShape(Shown(text));
}

v1::PointParameters ParametersMessage(const PointParameters& parameters) {
  v1::PointParameters message;
  for (const Parameter* parameter : kParameters) {
    const auto& value = parameters.Find(*parameter);
    if (!value || parameter == &kCells) continue;
    message.GetReflection()->SetDouble(&message, FieldOf(message, *parameter), *value);
  }
  if (const auto& code = parameters.Find(kCells)) message.set_cells(Text(ShapeOf(*code)));
  return message;
}

PointParameters ParametersOf(const v1::PointParameters& message) {
  PointParameters parameters;
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  for (const Parameter* parameter : kParameters) {
    const auto* field = FieldOf(message, *parameter);
    if (parameter == &kCells || (field->has_presence() && !reflection.HasField(message, field))) {
      continue;
    }
    parameters.Set(*parameter, reflection.GetDouble(message, field));
  }
  const absl::StatusOr<GasShape> shape = ParseGasShape(message.cells());
  if (shape.ok()) parameters.Set(kCells, CodeOf(*shape));
  return parameters;
}

v1::EnsembleSpec::Model ModelMessage(Model model) {
  return std::ranges::find(kModels, model, &std::pair<v1::EnsembleSpec::Model, Model>::second)
      ->first;
}

std::string QuestionBytes(v1::EnsembleSpec message) {
  // The order of the names means nothing.
  if (message.grid().table_size() > 1) std::ranges::sort(*message.mutable_grid()->mutable_table());
  if (message.model() == v1::EnsembleSpec::AUTO) message.clear_model();
  if (message.precision() == v1::EnsembleSpec::DOUBLE) message.clear_precision();
  v1::Target& target = *message.mutable_target();
  const ExperimentKind* const experiment =
      FindExperiment(static_cast<uint64_t>(message.experiment()));
  if (experiment != nullptr && experiment->aims.front().name == target.estimate()) {
    target.clear_estimate();
  }
  if (target.has_samples() && target.samples() == kDefaultSamples) target.clear_samples();
  if (target.ByteSizeLong() == 0) message.clear_target();
  return DeterministicBytes(message);
}

}  // namespace ballpiston::server
