#include "core/model_choice/ladder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/model_choice/question.h"

namespace ballpiston {
namespace {

constexpr absl::string_view kWithThePilot = "; with the pilot";

std::string CannotAnswer(Model model, const Question& question) {
  return absl::StrCat(
      model == Model::kClosedForm ? "there is no closed form for " : "this model does not answer ",
      question.subject());
}

void PredictWithoutSamples(const Machine& machine, Rung& rung) {
  const bool closed = rung.model == Model::kClosedForm;
  rung.samples = 0;
  rung.work = rung.time = closed ? machine.rates.closed_form : machine.rates.spectrum;
  rung.statistical_error = 0;
  if (closed) {
    rung.model_error = 0;
    rung.reason = "exact at every delta";
  }
}

void PredictSamples(const Question& question, Rung& rung) {
  if (!IsOfTheLimit(rung.model)) {
    rung.model_error = question.ErrorOfPrecision(rung.model);
    rung.reason = rung.model_error == 0 ? "exact" : "the billiard in single precision";
  }
  rung.samples = question.SamplesBy(rung.model);
  if (*rung.samples == 0) {
    rung.reason = "the budget ends before the first samples";
    return;
  }
  const double work = question.SecondsOf(rung.model, *rung.samples);
  if (std::isfinite(work)) {
    rung.work = work;
    rung.time = work / question.ThreadsFor(rung.model, *rung.samples);
  }
  const double error = question.ScatterBy(rung.model).ErrorOf(*rung.samples);
  if (std::isfinite(error)) rung.statistical_error = error;
}

// The limit's error: from the pilot that the choice has used, else the expected error.
void SetLimitError(const Question& question, const std::optional<Pilot>& pilot, Rung& rung) {
  rung.reason = "the limit delta -> 0";
  rung.model_error = question.LimitError();
  if (!rung.model_error) return;
  rung.reason = "the limit delta -> 0; the model error is an expected upper bound";
  if (!pilot) return;
  const PilotPlace place = PilotPlaceFor(question.point());
  rung.model_error = LimitErrorBound(*pilot, place, question.point());
  rung.reason = absl::StrCat("the limit delta -> 0; the model error is an upper bound, ",
                             FoundBy(*pilot, place));
}

Rung RungFor(Model model, const Question& question, const Machine& machine,
             const std::optional<Pilot>& pilot) {
  Rung rung;
  rung.model = model;
  rung.answers = question.aim().IsAnsweredBy(model);
  rung.memory = rung.answers ? question.MemoryBy(model) : 0;
  if (!rung.answers) {
    rung.reason = CannotAnswer(model, question);
    return rung;
  }
  if (IsABilliard(model) && !question.IsSoundForBilliard()) {
    rung.answers = false;
    rung.reason = "rounding: this model is not sound at this rho and delta";
    return rung;
  }
  if (TakesSamples(model)) {
    PredictSamples(question, rung);
  } else {
    PredictWithoutSamples(machine, rung);
  }
  const bool has_samples = !TakesSamples(model) || rung.samples.value_or(0) > 0;
  if (IsOfTheLimit(model) && has_samples) SetLimitError(question, pilot, rung);
  return rung;
}

auto IsBy(Model model) {
  return [model](const Rung& rung) { return rung.model == model; };
}

void AddPilot(const MachineRates& rates, Ladder& ladder) {
  ladder.work_of_pilot = SecondsOfPilot(*ladder.pilot, rates);
  Rung& chosen = ladder.Chosen();
  chosen.work = chosen.work.value_or(0) + ladder.work_of_pilot;
  chosen.time += ladder.work_of_pilot;
  chosen.reason = absl::StrCat(chosen.reason, kWithThePilot);
}

}  // namespace

const Rung& Ladder::Chosen() const {
  return *std::find_if(rungs.begin(), rungs.end(), IsBy(answer.model));
}

Rung& Ladder::Chosen() { return *std::find_if(rungs.begin(), rungs.end(), IsBy(answer.model)); }

void Ladder::DropPilot() {
  if (!pilot) return;
  Chosen().work = *Chosen().work - work_of_pilot;
  Chosen().time -= std::exchange(work_of_pilot, 0);
  Chosen().reason.resize(Chosen().reason.size() - kWithThePilot.size());
  pilot.reset();
}

Ladder LadderFor(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine,
                 const PilotSource& pilots) {
  const Question question(spec, point, machine);
  Ladder ladder;
  std::optional<Pilot> used;
  ladder.answer = *ChooseAnswer(spec, point, machine, [&](const PilotPlace& place) {
    used = pilots(place);
    if (!used) {
      ladder.pilot = place;
      used = PredictedPilot(place);
    }
    return used;
  });
  for (const Model model : kLadder) {
    ladder.rungs.push_back(RungFor(model, question, machine, used));
  }
  if (ladder.pilot) AddPilot(machine.rates, ladder);
  return ladder;
}

}  // namespace ballpiston
