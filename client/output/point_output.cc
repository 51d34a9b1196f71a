#include "client/output/point_output.h"

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"
#include "client/output/table.h"

namespace ballpiston::client {
namespace {

// The model's name on the command line; "none" if no model can be used.
std::string ModelName(v1::EnsembleSpec::Model model) {
  return model == v1::EnsembleSpec::MODEL_UNSPECIFIED ? "none" : Spelling(model);
}

// Prints, below a table, the reason why each model was chosen. Each reason is printed once, even if
// several points share it. The reasons are in the order of their first points.
//
//   closed-form: exact                                          one reason for all points
//
//   markov (rho 0.53, delta 0.0125): off by 1.2e-03             several reasons: each with its
//   billiard (rho 0.53, delta 0.1 and 2 more points): ...       first point
//
// `points` are PointResults or PointPlans; one without a reason has the model that the user chose.
template <typename Points>
void PrintModelReasons(const Points& points, std::ostream& out) {
  std::map<std::pair<std::string, std::string>, int> counts;  // of points, by model and reason
  for (const auto& point : points) {
    if (!point.reason().empty()) ++counts[{ModelName(point.model()), point.reason()}];
  }
  const bool is_only = counts.size() == 1;
  for (const auto& point : points) {
    const auto first = counts.extract({ModelName(point.model()), point.reason()});
    if (first.empty()) continue;  // printed already, or no reason
    out << first.key().first;
    if (!is_only) {
      const int others = first.mapped() - 1;
      out << " (" << ParameterText(point.parameters())
          << (others > 0 ? " and " + Counted(others, "more point") : "") << ")";
    }
    out << ": " << point.reason() << '\n';
  }
}

// ---- results ----

const Cells kPointFields = {"model", "samples"};
const Cells kEstimateFields = {"name",    "value",       "standard_error", "exact",
                               "z_score", "model_error", "noise_floor",    "limit"};

// A row for each estimate.
void PrintCsvRows(const Cells& parameters, const v1::PointResult& point, std::ostream& out) {
  const Cells first =
      Joined({FieldTexts(point.parameters(), parameters), FieldTexts(point, kPointFields)});
  for (const v1::Estimate& estimate : point.estimates()) {
    out << CsvRow(Joined({first, FieldTexts(estimate, kEstimateFields)}));
  }
}

// Columns that a table has only if at least one estimate has the value.
const Cells kExtraColumns = {"model_error", "noise_floor", "limit"};

// An error is printed with two digits; another value ends at the estimate's decimal place.
std::string ExtraCell(const std::string& column, const v1::Estimate& row) {
  const std::optional<double> x = NumberIn(row, column);
  if (!x) return "";
  if (column == "model_error") return TwoDigits(*x);
  return Measured(row.value(), NumberIn(row, "standard_error"), x).exact;
}

Cells EstimateCells(const v1::Estimate& row) {
  const MeasuredText text =
      Measured(row.value(), NumberIn(row, "standard_error"), NumberIn(row, "exact"));
  const bool has_z = row.has_z_score() && !text.error.empty();
  const std::string z = has_z ? absl::StrFormat("%+.2f", row.z_score()) : "";
  Cells cells = {row.name(), text.value, text.error, text.exact, z};
  for (const std::string& column : kExtraColumns) cells.push_back(ExtraCell(column, row));
  return cells;
}

std::string ResultHeading(const v1::EnsembleJob& job, const std::set<std::string>& models) {
  return absl::StrCat(
      Spelling(job.spec().experiment()), ", ",
      models.empty() ? "no finished points" : absl::StrCat("model ", absl::StrJoin(models, ", ")),
      job.spec().precision() == v1::EnsembleSpec::SINGLE ? ", single precision" : "", ", seed ",
      job.spec().seed(), ", engine ", job.engine_version(), "  (", job.name(), ", ",
      Spelling(job.state()), ", ", job.progress().points_done(), " of ", job.progress().points(),
      " points)");
}

void PrintResultTable(const v1::EnsembleJob& job, const std::vector<v1::PointResult>& points,
                      std::ostream& out) {
  std::set<std::string> models;
  for (const v1::PointResult& point : points) models.insert(Spelling(point.model()));
  std::set<std::string> optional = OptionalParameters();
  optional.insert(kExtraColumns.begin(), kExtraColumns.end());
  optional.insert("model");
  TextTable table(Joined({ParametersInTable(),
                          {"model", "samples", "estimate", "value", "error", "exact", "z"},
                          kExtraColumns}),
                  {"model", "estimate"}, optional);
  for (const v1::PointResult& point : points) {
    const Cells cells =
        Joined({FieldTexts(point.parameters(), ParametersInTable(), &TenDigits),
                {models.size() > 1 ? Spelling(point.model()) : "", ExactText(point.samples())}});
    for (const auto& row : point.estimates()) table.AddRow(Joined({cells, EstimateCells(row)}));
    for (const std::string& remark : point.remarks()) table.AddLine("remark: " + remark);
  }
  out << ResultHeading(job, models) << '\n';
  if (!points.empty()) table.Print(out);
  PrintModelReasons(points, out);
}

// ---- plans ----

bool IsChosen(const v1::PointPlan& point, const v1::ModelPlan& model) {
  return point.model() == model.model() && model.model() != v1::EnsembleSpec::MODEL_UNSPECIFIED;
}

std::string WholeReason(const v1::PointPlan& point, const v1::ModelPlan& model) {
  if (!IsChosen(point, model) || point.reason().empty()) return model.reason();
  if (model.reason().empty() || model.reason() == point.reason()) return point.reason();
  return absl::StrCat(point.reason(), "; ", model.reason());
}

void PrintPlanCsv(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan,
                  std::ostream& out) {
  const Cells parameters = ParametersInCsv(spec.grid());
  const Cells fields = {"answers", "samples", "work", "relative_statistical_error",
                        "relative_model_error"};
  out << CsvRow(Joined({parameters, {"model", "chosen"}, fields, {"reason"}}));
  for (const v1::PointPlan& point : plan.points()) {
    for (const v1::ModelPlan& model : point.models()) {
      const char* const chosen = IsChosen(point, model) ? "true" : "false";
      out << CsvRow(Joined({FieldTexts(point.parameters(), parameters),
                            {Spelling(model.model()), chosen},
                            FieldTexts(model, fields),
                            {WholeReason(point, model)}}));
    }
  }
}

std::string BudgetText(const google::protobuf::Duration& budget) {
  const double seconds = static_cast<double>(budget.seconds()) + 1e-9 * budget.nanos();
  return absl::StrFormat("budget %.6g s", seconds);
}

// Empty if the user gave no target: the server then uses its default.
std::string TargetText(const v1::Target& target) {
  Cells texts;
  if (!target.estimate().empty()) texts.push_back(absl::StrCat("estimate ", target.estimate()));
  if (target.has_samples()) texts.push_back(absl::StrCat(target.samples(), " samples per point"));
  if (target.has_collisions()) {
    texts.push_back(absl::StrCat(target.collisions(), " collisions per point"));
  }
  if (target.has_tolerance()) {
    texts.push_back(absl::StrFormat("tolerance %.6g", target.tolerance()));
  }
  if (target.has_budget()) texts.push_back(BudgetText(target.budget()));
  return absl::StrJoin(texts, ", ");
}

std::string PlanHeading(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan) {
  Cells texts = {Spelling(spec.experiment()), TargetText(spec.target()),
                 Counted(plan.point_count(), "point")};
  if (texts[1].empty()) texts.erase(texts.begin() + 1);
  return absl::StrCat(absl::StrJoin(texts, ", "), "  (work of one core, relative errors)");
}

// Large counts are shortened: 4.1e+08.
std::string SampleCountText(double count) {
  constexpr double kReadable = 1e7;
  return count < kReadable ? absl::StrFormat("%.0f", count) : absl::StrFormat("%.1e", count);
}

std::string RelativeError(double error) {
  return error == 0 ? "0" : absl::StrFormat("%.1e", error);
}

const Cells kCostTitles = {"samples", "work", "stat. error", "model error"};

Cells CostCells(const v1::ModelPlan& model) {
  return {FieldText(model, "samples", &SampleCountText), FieldText(model, "work", &DurationText),
          FieldText(model, "relative_statistical_error", &RelativeError),
          FieldText(model, "relative_model_error", &RelativeError)};
}

void PrintLadder(const v1::PointPlan& point, std::ostream& out) {
  TextTable table(Joined({{"", "model", "answers"}, kCostTitles, {"remark"}}),
                  {"", "model", "answers", "remark"});
  for (const v1::ModelPlan& model : point.models()) {
    const Cells begin = {IsChosen(point, model) ? ">" : "", Spelling(model.model()),
                         model.answers() ? "yes" : "no"};
    table.AddRow(Joined({begin, CostCells(model), {model.reason()}}));
  }
  out << '\n' << ParameterText(point.parameters()) << '\n';
  table.Print(out, 1);
  if (!point.reason().empty()) {
    out << " > " << ModelName(point.model()) << ": " << point.reason() << '\n';
  }
}

const v1::ModelPlan& ChosenModel(const v1::PointPlan& point) {
  for (const v1::ModelPlan& model : point.models()) {
    if (IsChosen(point, model)) return model;
  }
  return v1::ModelPlan::default_instance();
}

void PrintChoices(const v1::PlanEnsembleJobResponse& plan, std::ostream& out) {
  const Cells parameters = ParametersInTable();
  TextTable table(Joined({parameters, {"model"}, kCostTitles}), {"model"}, OptionalParameters());
  for (const v1::PointPlan& point : plan.points()) {
    const Cells cells = FieldTexts(point.parameters(), parameters, &TenDigits);
    table.AddRow(Joined({cells, {ModelName(point.model())}, CostCells(ChosenModel(point))}));
  }
  out << '\n';
  table.Print(out);
  PrintModelReasons(plan.points(), out);
}

void PrintTotal(const v1::PlanEnsembleJobResponse& plan, std::ostream& out) {
  const bool all = plan.points_size() == plan.point_count();
  out << '\n';
  if (!all) out << "Shown: " << plan.points_size() << " points, evenly spread over the grid.\n";
  out << Counted(plan.point_count(), "point") << ": " << DurationText(plan.work())
      << " of one core, " << DurationText(plan.time()) << " with this server's "
      << Counted(plan.workers(), "worker")
      << absl::StrFormat(", up to %.0f MB of memory\n", std::ceil(plan.memory() / 1e6));
}

void PrintPlanTable(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan,
                    std::ostream& out) {
  out << PlanHeading(spec, plan) << '\n';
  if (plan.points_size() <= kMostLadders) {
    for (const v1::PointPlan& point : plan.points()) PrintLadder(point, out);
  } else {
    PrintChoices(plan, out);
  }
  PrintTotal(plan, out);
}

}  // namespace

void ResultWriter::Begin(const v1::EnsembleJob& job) {
  job_ = job;
  if (format_ == Format::kJson) {
    out_ << "{\"client_version\": \"" << BALLPISTON_VERSION << "\",\n\"job\": " << Json(job)
         << ",\n\"points\": [";
  }
  if (format_ != Format::kCsv) return;
  if (is_file_) {
    out_ << "# " << job.name() << ", engine " << job.engine_version() << ", client "
         << BALLPISTON_VERSION << "\n# " << Json(job.spec()) << '\n';
  }
  parameters_ = ParametersInCsv(job.spec().grid());
  out_ << CsvRow(Joined({parameters_, kPointFields, kEstimateFields}));
}

void ResultWriter::Add(const v1::PointResult& point) {
  switch (format_) {
    case Format::kTable:
      points_.push_back(point);
      break;
    case Format::kJson:
      out_ << separator_ << Json(point);
      separator_ = ",\n";
      break;
    case Format::kJsonl:
      out_ << Json(point) << '\n';
      break;
    case Format::kCsv:
      PrintCsvRows(parameters_, point, out_);
  }
}

void ResultWriter::End() {
  if (format_ == Format::kTable) PrintResultTable(job_, points_, out_);
  if (format_ == Format::kJson) out_ << "\n]}\n";
}

void PrintPlan(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan, Format format,
               std::ostream& out) {
  if (format == Format::kTable) return PrintPlanTable(spec, plan, out);
  if (format == Format::kCsv) return PrintPlanCsv(spec, plan, out);
  if (format == Format::kJsonl) return PrintJsonLines(plan.points(), out);
  out << Json(plan) << '\n';
}

}  // namespace ballpiston::client
