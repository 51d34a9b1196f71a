// ChooseAnswer: the choice of the model.
#include <cmath>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/model_choice/ladder.h"
#include "core/model_choice/question.h"

namespace ballpiston {
namespace {

constexpr absl::string_view kInSinglePrecision = "in single precision; ";

// The billiard as the answer; `why` is the reason that no cheaper model answers.
Answer Billiard(const Question& question, absl::string_view why) {
  const std::optional<double> error = question.ModelErrorOf(Model::kBilliard);
  return {Model::kBilliard, absl::StrCat(error == 0 ? "exact; " : kInSinglePrecision, why), error};
}

Answer ByItsBound(const Question& question, double error) {
  const bool samples = TakesSamples(question.ModelOfLimit());
  const bool is_within = question.IsWithinTolerance(error);
  const std::string why = absl::StrCat("the limit's error, up to ", Rounded(error), ", is ",
                                       is_within ? "within " : "beyond ",
                                       samples ? "half of the tolerance" : "the tolerance");
  if (!is_within) return Billiard(question, why);
  return {question.ModelOfLimit(), why, error};
}

// The model that has the smaller error within the budget; the limit if none has an error.
Answer ByBudget(const Question& question, double bound) {
  if (!question.IsWithinTolerance(bound)) return ByItsBound(question, bound);
  const double limit = question.ErrorInBudget(question.ModelOfLimit()) + bound;
  const double billiard = question.ErrorInBudget(Model::kBilliard) +
                          question.ModelErrorOf(Model::kBilliard).value_or(0);
  const std::string compared = absl::StrCat(
      std::isfinite(billiard)
          ? absl::StrCat("the billiard's error with this budget is about ", Rounded(billiard))
          : "the billiard has no error within this budget",
      ", the limit's ",
      std::isfinite(limit) ? absl::StrCat("about ", Rounded(limit),
                                          ", of which the model error is at most ", Rounded(bound))
                           : absl::StrCat("model error at most ", Rounded(bound)));
  const double enough = question.target().tolerance.value_or(0);
  const bool is_by_billiard = std::isfinite(billiard)
                                  ? billiard <= std::max(limit, enough)
                                  : question.SamplesInBudget(question.ModelOfLimit()) == 0;
  if (is_by_billiard) return Billiard(question, compared);
  return {question.ModelOfLimit(), compared, bound};
}

// Outside of the billiard's domain the limit answers if a tolerance permits its error, or with a
// budget.
Answer AnswerNearTheLimit(const Question& question) {
  const std::optional<double> error = question.LimitError();
  if (!error) return Billiard(question, "the limit's error is not known at this point");
  if (!question.IsSoundForBilliard() && question.target().IsOpenEnded() &&
      question.IsWithinTolerance(*error)) {
    return {question.ModelOfLimit(), "the billiard is not sound at this point", *error};
  }
  if (!question.HasRelativeError()) {
    return Billiard(question,
                    "the first estimate has no relative error at this point, so the limit's error "
                    "cannot be judged");
  }
  if (question.target().budget_seconds) return ByBudget(question, *error);
  if (question.target().tolerance) return ByItsBound(question, *error);
  return Billiard(question, "without a tolerance the limit's error cannot be judged");
}

std::string NothingCheaper(const Question& question) {
  if (!question.aim().IsAnsweredBy(Model::kMarkov)) {
    return absl::StrCat("no cheaper model answers ", question.subject());
  }
  return absl::StrCat("the limit's error is not known for ", question.subject());
}

Answer AutoAnswer(const Question& question) {
  const bool verify = question.spec().verify;
  if (question.aim().HasClosedForm()) {
    if (!verify) return {Model::kClosedForm, "exact at every delta, no sampling", 0.0};
    return Billiard(question, "verify is set, so the closed form is not used");
  }
  if (question.HasLimit()) return AnswerNearTheLimit(question);
  return Billiard(question, NothingCheaper(question));
}

// The limit's errors in other estimates of the answer.
void AddFurtherErrors(const Question& question, Answer& answer) {
  if (!IsOfTheLimit(answer.model)) return;
  for (const AimedEstimate& aim : question.spec().experiment->aims) {
    const bool is_first = &aim == &question.aim();
    const std::optional<double> error =
        is_first ? answer.model_error : aim.LimitErrorAt(question.point());
    if (!error) continue;
    if (!is_first) answer.further_errors.emplace(aim.name, *error);
    for (const absl::string_view name : aim.multiples) answer.further_errors.emplace(name, *error);
  }
}

}  // namespace

double BudgetOfAPoint(const EnsembleSpec& spec, int workers) {
  return *spec.target.budget_seconds * workers / static_cast<double>(PointCount(spec));
}

Answer ChooseAnswer(const EnsembleSpec& spec, const PointParameters& point,
                    const Machine& machine) {
  const Question question(spec, point, machine);
  Answer answer = spec.model == Model::kAuto
                      ? AutoAnswer(question)
                      : Answer{spec.model, "", question.ModelErrorOf(spec.model)};
  AddFurtherErrors(question, answer);
  return answer;
}

}  // namespace ballpiston
