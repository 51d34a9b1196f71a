#include "client/output/model_reasons.h"

#include "absl/strings/str_cat.h"
#include "client/output/field_text.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

std::string AndMore(int others) {
  if (others == 0) return "";
  return absl::StrCat(" and ", Counted(others, "more point"));
}

}  // namespace

std::string ModelName(v1::EnsembleSpec::Model model) {
  return model == v1::EnsembleSpec::MODEL_UNSPECIFIED ? "none" : Spelling(model);
}

void ModelReasons::Add(const v1::PointParameters& parameters, v1::EnsembleSpec::Model model,
                       const std::string& reason) {
  if (reason.empty()) return;
  const auto [position, is_new] =
      positions_.try_emplace({ModelName(model), reason}, reasons_.size());
  if (is_new) reasons_.push_back({ModelName(model), reason, parameters});
  ++reasons_[position->second].points;
}

std::string ModelReasons::Line(const Reason& reason) const {
  if (reasons_.size() == 1) return absl::StrCat(reason.model, ": ", reason.text);
  return absl::StrCat(reason.model, " (", ParameterText(reason.first_point),
                      AndMore(reason.points - 1), "): ", reason.text);
}

void ModelReasons::Print(std::ostream& out) const {
  for (const Reason& reason : reasons_) out << Line(reason) << '\n';
}

}  // namespace ballpiston::client
