#include "core/model_choice/ladder.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/model_choice/question.h"

namespace ballpiston {
namespace {

std::string CannotAnswer(Model model, const Question& question) {
  return absl::StrCat(
      model == Model::kClosedForm ? "there is no closed form for " : "this model does not answer ",
      question.subject());
}

void PredictSamples(const Question& question, const Machine& machine, Rung& rung) {
  const double samples = question.SamplesBy(rung.model);
  rung.samples = samples;
  if (samples == 0) {
    rung.reason = "the budget ends before the first samples";
    return;
  }
  const SamplingCost cost = question.CostBy(rung.model);
  const double work =
      cost.Of(samples, machine.workers) + question.spec().experiment->summary * machine.rates.jump;
  if (std::isfinite(work)) {
    rung.work = work;
    rung.time = work / cost.ThreadsFor(samples, machine.workers);
  }
  const double error = question.ScatterBy(rung.model).ErrorOf(samples);
  if (std::isfinite(error)) rung.statistical_error = error;
}

void SetModelError(const Question& question, Rung& rung) {
  rung.model_error = question.ModelErrorOf(rung.model);
  if (rung.model == Model::kClosedForm) {
    rung.reason = "exact at every delta";
  } else if (!IsOfTheLimit(rung.model)) {
    rung.reason = rung.model_error == 0 ? "exact" : "the billiard in single precision";
  } else {
    rung.reason = absl::StrCat("the limit delta -> 0",
                               rung.model_error ? "; the model error is an upper bound" : "");
  }
}

Rung RungFor(Model model, const Question& question, const Machine& machine) {
  Rung rung;
  rung.model = model;
  if (!question.aim().IsAnsweredBy(model)) {
    rung.reason = CannotAnswer(model, question);
    return rung;
  }
  rung.memory = question.MemoryBy(model);
  if (IsABilliard(model) && !question.IsSoundForBilliard()) {
    rung.reason = "rounding: this model is not sound at this point";
    return rung;
  }
  rung.answers = true;
  SetModelError(question, rung);
  if (TakesSamples(model)) {
    PredictSamples(question, machine, rung);
  } else {
    const bool is_closed = model == Model::kClosedForm;
    rung.samples = rung.statistical_error = 0;
    rung.work = rung.time = is_closed ? machine.rates.closed_form : machine.rates.spectrum;
  }
  return rung;
}

}  // namespace

const Rung& Ladder::Chosen() const { return *std::ranges::find(rungs, answer.model, &Rung::model); }

Ladder LadderFor(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine) {
  const Question question(spec, point, machine);
  Ladder ladder;
  ladder.answer = ChooseAnswer(spec, point, machine);
  for (const Model model : kLadder) ladder.rungs.push_back(RungFor(model, question, machine));
  return ladder;
}

}  // namespace ballpiston
