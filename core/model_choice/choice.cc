// ChooseAnswer: the choice of the model.
#include <cmath>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/experiment/all_experiments.h"
#include "core/model_choice/ladder.h"
#include "core/model_choice/question.h"

namespace ballpiston {
namespace {

constexpr absl::string_view kInSinglePrecision = "in single precision; ";

// The costs of a pilot and of the billiard itself, in wall hits. They are not in seconds, so that
// every machine makes the same choice.
double HitsOf(const PointParameters& point, double orbits) {
  constexpr double kHitsThatACollisionCosts = 100;
  const SampleWork work = kEnergyRelaxation.forecast(Model::kBilliard, point).work;
  return orbits * (work.ball_wall + kHitsThatACollisionCosts * work.collisions);
}

// A few hours of a core. Where the discs nearly touch, a pilot may take longer than any machine
// lasts.
constexpr double kMostHitsOfAPilot = 1e13;

// The billiard as the answer; `why` is the reason that no cheaper model answers.
Answer Billiard(const Question& question, absl::string_view why) {
  const std::optional<double> error = question.ModelErrorOf(Model::kBilliard);
  return {Model::kBilliard, absl::StrCat(error == 0 ? "exact; " : kInSinglePrecision, why), error};
}

// The reason why no pilot is needed; empty if a pilot is needed.
std::string WithoutAPilot(const Question& question, const PilotPlace& place) {
  const double tolerance = *question.target().tolerance;
  const Pilot predicted = PredictedPilot(place);
  const Pilot at_best = {.difference = 0, .standard_error = predicted.standard_error};
  if (LimitErrorBound(at_best, place, question.point()) > tolerance) {
    return "a pilot could not establish the limit's error to this tolerance";
  }
  const double samples = question.ScatterBy(Model::kBilliard).SamplesFor(tolerance);
  if (HitsOf(question.point(), samples) < HitsOf(place, kPilotOrbits)) {
    return "the billiard reaches the tolerance before a pilot would establish the limit's error";
  }
  return "";
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

std::optional<Answer> ByTolerance(const Question& question, double expected,
                                  const PilotSource& pilots) {
  if (!question.HasPilots() || !question.IsWithinTolerance(expected)) {
    return ByItsBound(question, expected);
  }
  const PilotPlace place = PilotPlaceFor(question.point());
  if (const std::string why = WithoutAPilot(question, place); !why.empty()) {
    return Billiard(question, why);
  }
  if (HitsOf(place, kPilotOrbits) > kMostHitsOfAPilot) return ByItsBound(question, expected);
  const std::optional<Pilot> pilot = pilots(place);
  if (!pilot) return std::nullopt;
  const double error = LimitErrorBound(*pilot, place, question.point());
  const std::string found =
      absl::StrCat("the limit's error is within ", Rounded(error), ", ", FoundBy(*pilot, place));
  if (error > *question.target().tolerance) {
    return Billiard(question, absl::StrCat(found, ": beyond the tolerance"));
  }
  return Answer{question.ModelOfLimit(), absl::StrCat(found, ": within the tolerance"), error};
}

// The model that has the smaller error within the budget; the limit if none has an error. Runs no
// pilot, because a pilot would use part of the budget.
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

// Outside of the billiard's domain the limit answers by its expected error, without a pilot, if a
// tolerance permits it, or with a budget.
std::optional<Answer> AnswerNearTheLimit(const Question& question, const PilotSource& pilots) {
  const std::optional<double> error = question.LimitError();
  if (!error) return Billiard(question, "the limit's error is not known at this point");
  if (!question.IsSoundForBilliard() && question.target().IsOpenEnded() &&
      question.IsWithinTolerance(*error)) {
    return Answer{question.ModelOfLimit(), "the billiard is not sound at this rho and delta",
                  *error};
  }
  if (!question.HasRelativeError()) {
    return Billiard(question,
                    "the first estimate has no relative error at this point, so the limit's error "
                    "cannot be judged");
  }
  if (question.target().budget_seconds) return ByBudget(question, *error);
  if (question.target().tolerance) return ByTolerance(question, *error, pilots);
  return Billiard(question, "without a tolerance the limit's error cannot be judged");
}

std::string NothingCheaper(const Question& question) {
  if (!question.aim().IsAnsweredBy(Model::kMarkov)) {
    return absl::StrCat("no cheaper model answers ", question.subject());
  }
  return absl::StrCat("the limit's error is not known for ", question.subject());
}

std::optional<Answer> AutoAnswer(const Question& question, const PilotSource& pilots) {
  const bool verify = question.spec().verify;
  if (question.aim().HasClosedForm()) {
    if (!verify) return Answer{Model::kClosedForm, "exact at every delta, no sampling", 0.0};
    return Billiard(question, "verify is set, so the closed form is not used");
  }
  if (question.HasLimit()) return AnswerNearTheLimit(question, pilots);
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

std::optional<Answer> ChooseAnswer(const EnsembleSpec& spec, const PointParameters& point,
                                   const Machine& machine, const PilotSource& pilots) {
  const Question question(spec, point, machine);
  std::optional<Answer> answer = spec.model == Model::kAuto
                                     ? AutoAnswer(question, pilots)
                                     : Answer{spec.model, "", question.ModelErrorOf(spec.model)};
  if (answer) AddFurtherErrors(question, *answer);
  return answer;
}

}  // namespace ballpiston
