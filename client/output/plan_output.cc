#include "client/output/plan_output.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/csv_row.h"
#include "client/output/json.h"
#include "client/output/model_reasons.h"
#include "client/output/number_text.h"
#include "client/output/parameter_text.h"
#include "client/output/spelling.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

using Cells = std::vector<std::string>;

void Append(const Cells& more, Cells& cells) {
  cells.insert(cells.end(), more.begin(), more.end());
}

bool IsChosen(const v1::PointPlan& point, const v1::ModelPlan& model) {
  return point.model() == model.model() && model.model() != v1::EnsembleSpec::MODEL_UNSPECIFIED;
}

std::string WholeReason(const v1::PointPlan& point, const v1::ModelPlan& model) {
  if (!IsChosen(point, model) || point.reason().empty()) return model.reason();
  if (model.reason().empty() || model.reason() == point.reason()) return point.reason();
  return absl::StrCat(point.reason(), "; ", model.reason());
}

Cells CsvCells(const ParameterColumns& parameters, const v1::PointPlan& point,
               const v1::ModelPlan& model) {
  const auto number = [](bool known, double x) { return known ? ExactText(x) : ""; };
  const auto truth = [](bool holds) { return holds ? "true" : "false"; };
  Cells cells = parameters.Cells(point.parameters());
  Append({Spelling(model.model()), truth(IsChosen(point, model)), truth(model.answers()),
          number(model.has_samples(), model.samples()), number(model.has_work(), model.work()),
          number(model.has_relative_statistical_error(), model.relative_statistical_error()),
          number(model.has_relative_model_error(), model.relative_model_error()),
          WholeReason(point, model)},
         cells);
  return cells;
}

void PrintCsv(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan,
              std::ostream& out) {
  const ParameterColumns parameters(spec.grid());
  out << absl::StrJoin(parameters.Titles(), ",")
      << ",model,chosen,answers,samples,work,relative_statistical_error,relative_model_error,"
         "reason\n";
  for (const v1::PointPlan& point : plan.points()) {
    for (const v1::ModelPlan& model : point.models()) {
      out << CsvRow(CsvCells(parameters, point, model));
    }
  }
}

std::string Points(int count) { return absl::StrCat(count, count == 1 ? " point" : " points"); }

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

std::string Heading(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan) {
  Cells texts = {Spelling(spec.experiment()), TargetText(spec.target()),
                 Points(plan.point_count())};
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
  return {model.has_samples() ? SampleCountText(model.samples()) : "",
          model.has_work() ? DurationText(model.work()) : "",
          model.has_relative_statistical_error() ? RelativeError(model.relative_statistical_error())
                                                 : "",
          model.has_relative_model_error() ? RelativeError(model.relative_model_error()) : ""};
}

TextTable LadderTable() {
  constexpr auto kLeft = TextTable::Column::kLeft;
  std::vector<TextTable::Column> columns = {{"", kLeft}, {"model", kLeft}, {"answers", kLeft}};
  for (const std::string& title : kCostTitles) columns.push_back({title});
  columns.push_back({"remark", kLeft});
  return TextTable(columns);
}

void PrintLadder(const v1::PointPlan& point, std::ostream& out) {
  TextTable table = LadderTable();
  for (const v1::ModelPlan& model : point.models()) {
    Cells cells = {IsChosen(point, model) ? ">" : "", Spelling(model.model()),
                   model.answers() ? "yes" : "no"};
    Append(CostCells(model), cells);
    cells.push_back(model.reason());
    table.AddRow(std::move(cells));
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

TextTable ChoiceTable(const ParametersShown& shown) {
  std::vector<TextTable::Column> columns;
  for (const std::string& title : shown.Titles()) columns.push_back({title});
  columns.push_back({"model", TextTable::Column::kLeft});
  for (const std::string& title : kCostTitles) columns.push_back({title});
  return TextTable(columns);
}

void PrintChoices(const v1::PlanEnsembleJobResponse& plan, std::ostream& out) {
  ParametersShown shown;
  ModelReasons reasons;
  for (const v1::PointPlan& point : plan.points()) shown.Include(point.parameters());
  TextTable table = ChoiceTable(shown);
  for (const v1::PointPlan& point : plan.points()) {
    Cells cells = shown.Cells(point.parameters());
    cells.push_back(ModelName(point.model()));
    Append(CostCells(ChosenModel(point)), cells);
    table.AddRow(std::move(cells));
    reasons.Add(point.parameters(), point.model(), point.reason());
  }
  out << '\n';
  table.Print(out);
  reasons.Print(out);
}

void PrintTotal(const v1::PlanEnsembleJobResponse& plan, std::ostream& out) {
  const bool all = plan.points_size() == plan.point_count();
  out << '\n';
  if (!all) out << "Shown: " << plan.points_size() << " points, evenly spread over the grid.\n";
  out << Points(plan.point_count()) << ": " << DurationText(plan.work()) << " of one core, "
      << DurationText(plan.time()) << " with this server's " << plan.workers()
      << (plan.workers() == 1 ? " worker" : " workers")
      << absl::StrFormat(", up to %.0f MB of memory\n", std::ceil(plan.memory() / 1e6));
}

void PrintTable(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan,
                std::ostream& out) {
  out << Heading(spec, plan) << '\n';
  if (plan.points_size() <= kMostLadders) {
    for (const v1::PointPlan& point : plan.points()) PrintLadder(point, out);
  } else {
    PrintChoices(plan, out);
  }
  PrintTotal(plan, out);
}

}  // namespace

void PrintPlan(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan, Format format,
               std::ostream& out) {
  switch (format) {
    case Format::kTable:
      return PrintTable(spec, plan, out);
    case Format::kJson:
      out << Json(plan) << '\n';
      return;
    case Format::kJsonl:
      return PrintJsonLines(plan.points(), out);
    case Format::kCsv:
    case Format::kCsvHistograms:
    case Format::kCsvCurves:
      return PrintCsv(spec, plan, out);
  }
}

}  // namespace ballpiston::client
