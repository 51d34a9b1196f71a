#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/answers.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/model_reasons.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

bool IsChosen(const v1::PointPlan& point, const v1::ModelPlan& model) {
  return point.model() == model.model() && model.model() != v1::EnsembleSpec::MODEL_UNSPECIFIED;
}

std::string WholeReason(const v1::PointPlan& point, const v1::ModelPlan& model) {
  if (!IsChosen(point, model) || point.reason().empty()) return model.reason();
  if (model.reason().empty() || model.reason() == point.reason()) return point.reason();
  return absl::StrCat(point.reason(), "; ", model.reason());
}

void PrintCsv(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan,
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

std::string Heading(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan) {
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
  if (format == Format::kTable) return PrintTable(spec, plan, out);
  if (format == Format::kCsv) return PrintCsv(spec, plan, out);
  if (format == Format::kJsonl) return PrintJsonLines(plan.points(), out);
  out << Json(plan) << '\n';
}

}  // namespace ballpiston::client
