#include "core/model_choice/ladder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/answering_models.h"
#include "core/experiment/block_plan.h"
#include "core/experiment/energy_relaxation.h"
#include "core/experiment/predicted_hits.h"
#include "core/geometry/pair_geometry.h"
#include "core/model_choice/sampling_cost.h"

namespace ballpiston {
namespace {

constexpr double kClosedFormError = kMeanFreeTimeRelativeError + kConditionalRateRelativeError;

constexpr absl::string_view kWithThePilot = "; with the pilot";

std::string Rounded(double x) { return absl::StrFormat("%.2g", x); }

// Not below x: two digits are 4.8 % below what they round, at most.
std::string RoundedUp(double x) { return Rounded(1.05 * x); }

bool IsOfTheLimit(Model model) { return model == Model::kSpectrum || model == Model::kMarkov; }

// One point's question.
class Question {
 public:
  Question(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine)
      : spec_(OnePointSpec(spec, point, spec.model)),
        point_(point),
        machine_(machine),
        geometry_(PairGeometry::Create(point.rho, point.delta).value()) {}

  const EnsembleSpec& spec() const { return spec_; }
  const PointParameters& point() const { return point_; }
  const Target& target() const { return spec_.target; }
  bool relaxes() const { return spec_.experiment == Experiment::kEnergyRelaxation; }
  // Whether something is known of how far the limit is off.
  bool HasLimitError() const { return relaxes() && HasRelaxationTime(point_.epsilon); }

  double SecondsBy(Model model) const {
    return SecondsPerSample(By(model), geometry_, point_, machine_.rates);
  }

  // That the target takes by a model that samples.
  double SamplesBy(Model model) const {
    double samples =
        static_cast<double>(SamplesAskedFor(target(), relaxes() ? CollisionsPerOrbit(point_) : 1));
    if (target().tolerance) samples = std::min(samples, SamplesForTolerance(model));
    if (target().budget_seconds) samples = std::min(samples, SamplesInBudget(model));
    return samples;
  }

  double SamplesInBudget(Model model) const {
    return std::max(std::floor(BudgetOfAPoint(spec_, machine_.workers) / SecondsBy(model)), 1.0);
  }

  // At least the blocks before the first look.
  double SamplesForTolerance(Model model) const {
    const double block =
        static_cast<double>(PointExperiment::Create(By(model), 0)->plan().block_size);
    const double blocks = std::ceil(SamplesFor(*target().tolerance) / block);
    return std::max(blocks, static_cast<double>(kMinBlocks)) * block;
  }

  double SamplesFor(double tolerance) const {
    const double ratio = ErrorOf(1) / tolerance;
    return ratio * ratio;
  }

  double ErrorOf(double samples) const {
    return RelativeErrorOfOneSample(spec_.experiment, geometry_, point_) / std::sqrt(samples);
  }

 private:
  EnsembleSpec By(Model model) const { return OnePointSpec(spec_, point_, model); }

  EnsembleSpec spec_;  // of this point alone
  PointParameters point_;
  Machine machine_;
  PairGeometry geometry_;
};

// ---- which model ----

// What a pilot costs and the billiard itself would, in wall hits: not in this machine's seconds, so
// that every machine chooses alike.
double HitsOf(const PointParameters& point, double orbits) {
  constexpr double kHitsThatACollisionCosts = 100;
  const PairGeometry geometry = PairGeometry::Create(point.rho, point.delta).value();
  return orbits * CollisionsPerOrbit(point) *
         (HitsPerCollision(geometry).ball_wall + kHitsThatACollisionCosts);
}

Answer Billiard(std::string reason) { return {Model::kBilliard, std::move(reason), 0.0}; }

// Why the pilot need not even be asked for; empty if it has to be.
std::string WithoutAPilot(const Question& question) {
  const double tolerance = *question.target().tolerance;
  const PilotPlace place = PilotPlaceFor(question.point());
  const double expected = ExpectedLimitError(question.point());
  if (expected > tolerance) {
    return absl::StrCat("the limit's error, some ", Rounded(expected), ", is beyond the tolerance");
  }
  const Pilot predicted = PredictedPilot(place);
  const Pilot at_best = {.difference = 0, .standard_error = predicted.standard_error};
  if (LimitErrorBound(at_best, place, question.point()) > tolerance) {
    return "a pilot could not establish the limit's error to this tolerance";
  }
  if (HitsOf(question.point(), question.SamplesFor(tolerance)) <
      HitsOf(PointOf(place), static_cast<double>(kPilotOrbits))) {
    return "it reaches the tolerance sooner than a pilot would establish the limit's error";
  }
  return "";
}

std::string FoundBy(const Pilot& pilot, const PilotPlace& place) {
  return absl::StrCat(
      pilot.predicted ? "expected of a pilot at delta = " : "two sigma of a pilot at delta = ",
      Rounded(place.delta));
}

std::optional<Answer> ByTolerance(const Question& question, const PilotSource& pilots) {
  if (const std::string why = WithoutAPilot(question); !why.empty()) {
    return Billiard(absl::StrCat("exact; ", why));
  }
  const PilotPlace place = PilotPlaceFor(question.point());
  const std::optional<Pilot> pilot = pilots(place);
  if (!pilot) return std::nullopt;
  const double error = LimitErrorBound(*pilot, place, question.point());
  const std::string found =
      absl::StrCat("the limit's error is within ", Rounded(error), ", ", FoundBy(*pilot, place));
  if (error > *question.target().tolerance) {
    return Billiard(absl::StrCat("exact; ", found, ": beyond the tolerance"));
  }
  return Answer{Model::kSpectrum, absl::StrCat(found, ": within the tolerance"), error};
}

// Whichever is nearer to the truth in that time. Runs no pilot, which would take of it.
Answer ByBudget(const Question& question) {
  const double limit = ExpectedLimitError(question.point());
  const double billiard = question.ErrorOf(question.SamplesInBudget(Model::kBilliard));
  const std::string compared =
      absl::StrCat("the billiard's error after this budget is some ", Rounded(billiard),
                   ", the limit's some ", Rounded(limit));
  const double enough = question.target().tolerance.value_or(0);
  if (billiard <= std::max(limit, enough)) return Billiard(absl::StrCat("exact; ", compared));
  return {Model::kSpectrum, compared, limit};
}

std::optional<Answer> RelaxationBy(const Question& question, const PilotSource& pilots) {
  if (!question.HasLimitError()) return Billiard("exact; the limit's error is not known there");
  if (question.target().budget_seconds) return ByBudget(question);
  if (question.target().tolerance) return ByTolerance(question, pilots);
  return Billiard("exact; without a tolerance the limit's error cannot be weighed");
}

std::optional<Answer> AutoAnswer(const Question& question, const PilotSource& pilots) {
  const EnsembleSpec& spec = question.spec();
  if (HasClosedForm(spec.experiment)) {
    if (!spec.verify) return Answer{Model::kClosedForm, "exact at every delta, no sampling", 0.0};
    return Billiard("asked to verify the closed form");
  }
  if (question.relaxes()) return RelaxationBy(question, pilots);
  return Billiard(absl::StrCat("exact; nothing cheaper answers ", Name(spec.experiment)));
}

Answer ExplicitAnswer(const Question& question) {
  const Model model = question.spec().model;
  if (!IsOfTheLimit(model)) return {model, "", 0.0};
  if (!question.HasLimitError()) return {model, "", std::nullopt};
  return {model, "", ExpectedLimitError(question.point())};
}

// ---- all rungs ----

std::string CannotAnswer(Model model, Experiment experiment) {
  return absl::StrCat("there is no ", model == Model::kClosedForm ? "closed form" : "answer by it",
                      " for ", Name(experiment));
}

void PredictWithoutSamples(const Machine& machine, Rung& rung) {
  const bool closed = rung.model == Model::kClosedForm;
  rung.samples = 0;
  rung.work = closed ? machine.rates.closed_form : machine.rates.spectrum;
  rung.statistical_error = 0;
  if (closed) {
    rung.model_error = 0;
    rung.reason = "exact at every delta";
  }
}

void PredictSamples(const Question& question, Rung& rung) {
  rung.samples = question.SamplesBy(rung.model);
  const double work = *rung.samples * question.SecondsBy(rung.model);
  if (std::isfinite(work)) rung.work = work;
  const double error = question.ErrorOf(*rung.samples);
  if (std::isfinite(error)) rung.statistical_error = error;
  if (!IsOfTheLimit(rung.model)) {
    rung.model_error = 0;
    rung.reason = "exact";
  }
}

// What is known of the limit's error: a pilot, if one was run; else what is expected.
void SetLimitError(const Question& question, const PilotSource& pilots, Rung& rung) {
  rung.reason = "the limit delta -> 0";
  if (!question.HasLimitError()) return;
  const PilotPlace place = PilotPlaceFor(question.point());
  const std::optional<Pilot> pilot = pilots(place);
  const bool known = pilot.has_value();
  rung.model_error = known ? LimitErrorBound(*pilot, place, question.point())
                           : ExpectedLimitError(question.point());
  rung.reason = known ? absl::StrCat("the limit; so far off or less, ", FoundBy(*pilot, place))
                      : "the limit; expected to be so far off, by its scaling with delta";
}

Rung RungFor(Model model, const Question& question, const Machine& machine,
             const PilotSource& pilots) {
  Rung rung;
  rung.model = model;
  rung.answers = Answers(model, question.spec().experiment);
  if (!rung.answers) {
    rung.reason = CannotAnswer(model, question.spec().experiment);
    return rung;
  }
  if (model == Model::kClosedForm || model == Model::kSpectrum) {
    PredictWithoutSamples(machine, rung);
  } else {
    PredictSamples(question, rung);
  }
  if (IsOfTheLimit(model)) SetLimitError(question, pilots, rung);
  return rung;
}

auto IsBy(Model model) {
  return [model](const Rung& rung) { return rung.model == model; };
}

void AddPilot(const MachineRates& rates, Ladder& ladder) {
  ladder.work_of_pilot = SecondsOfPilot(*ladder.pilot, rates);
  Rung& chosen = ladder.Chosen();
  chosen.work = chosen.work.value_or(0) + ladder.work_of_pilot;
  chosen.reason = absl::StrCat(chosen.reason, kWithThePilot);
}

}  // namespace

double BudgetOfAPoint(const EnsembleSpec& spec, int workers) {
  return *spec.target.budget_seconds * workers / static_cast<double>(PointCount(spec));
}

std::optional<Answer> ChooseAnswer(const EnsembleSpec& spec, const PointParameters& point,
                                   const Machine& machine, const PilotSource& pilots) {
  const Question question(spec, point, machine);
  return spec.model == Model::kAuto ? AutoAnswer(question, pilots) : ExplicitAnswer(question);
}

const Rung& Ladder::Chosen() const {
  return *std::find_if(rungs.begin(), rungs.end(), IsBy(answer.model));
}

Rung& Ladder::Chosen() { return *std::find_if(rungs.begin(), rungs.end(), IsBy(answer.model)); }

void Ladder::DropPilot() {
  if (!pilot) return;
  Chosen().work = *Chosen().work - std::exchange(work_of_pilot, 0);
  Chosen().reason.resize(Chosen().reason.size() - kWithThePilot.size());
  pilot.reset();
}

Ladder LadderFor(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine,
                 const PilotSource& pilots) {
  const Question question(spec, point, machine);
  Ladder ladder;
  for (const Model model : kLadder) {
    ladder.rungs.push_back(RungFor(model, question, machine, pilots));
  }
  ladder.answer = *ChooseAnswer(spec, point, machine, [&](const PilotPlace& place) {
    if (const std::optional<Pilot> known = pilots(place)) return known;
    ladder.pilot = place;
    return std::optional(PredictedPilot(place));
  });
  if (ladder.pilot) AddPilot(machine.rates, ladder);
  return ladder;
}

namespace {

// What the answering model is off by itself, at the worst point; or, where it samples, its error
// after all the samples that there can be.
double LeastTolerance(const EnsembleSpec& spec) {
  const bool closed = spec.model == Model::kAuto && HasClosedForm(spec.experiment) && !spec.verify;
  if (closed || spec.model == Model::kClosedForm) return kClosedFormError;
  double least = 0;
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const PointParameters point = PointAt(spec, i);
    const bool relaxes = spec.experiment == Experiment::kEnergyRelaxation;
    if (IsOfTheLimit(spec.model) && relaxes) least = std::max(least, ExpectedLimitError(point));
    if (spec.model == Model::kSpectrum) continue;
    const Question question(spec, point, Machine());
    const double sampled = question.ErrorOf(static_cast<double>(kMaxSamples));
    if (std::isfinite(sampled)) least = std::max(least, sampled);
  }
  return least;
}

}  // namespace

std::vector<FieldViolation> ToleranceViolations(const EnsembleSpec& spec) {
  if (!spec.target.tolerance) return {};
  const double tolerance = *spec.target.tolerance, least = LeastTolerance(spec);
  if (!(tolerance < least)) return {};
  const std::string other = IsOfTheLimit(spec.model) ? ", or model auto or billiard" : "";
  return {{"target.tolerance",
           absl::StrCat("is ", NumberText(tolerance), ", below what model ", Name(spec.model),
                        " can reach; permitted: tolerance >= ", RoundedUp(least), other)}};
}

}  // namespace ballpiston
