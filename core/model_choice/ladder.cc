#include "core/model_choice/ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "core/billiard/single_precision.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/pair_experiment.h"
#include "core/gas/gas_shape.h"
#include "core/model_choice/sampling_cost.h"

namespace ballpiston {
namespace {

constexpr double kClosedFormError = kMeanFreeTimeRelativeError + kConditionalRateRelativeError;

constexpr absl::string_view kWithThePilot = "; with the pilot";
constexpr absl::string_view kInSinglePrecision = "in single precision; ";

std::string Rounded(double x) { return absl::StrFormat("%.2g", x); }

// Not below x: rounding to two digits lowers a number by at most 4.8 %.
std::string RoundedUp(double x) { return Rounded(1.05 * x); }

// One point's question.
class Question {
 public:
  Question(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine)
      : spec_(OnePointSpec(spec, point, spec.model)), point_(point), machine_(machine) {}

  const EnsembleSpec& spec() const { return spec_; }
  const PointParameters& point() const { return point_; }
  const Target& target() const { return spec_.target; }
  const AimedEstimate& aim() const { return AimOf(spec_); }
  bool HasLimit() const { return aim().limit_error != nullptr; }
  // Whether a bound of the limit's error is known.
  bool HasLimitError() const { return HasLimit() && aim().limit_error->is_known(point_); }
  // Whether pilots can check the bound. They are runs of energy-relaxation. In a gas a pilot would
  // take as long as the billiard's answer.
  bool HasPilots() const { return HasLimitError() && spec_.experiment == &kEnergyRelaxation; }
  double ExpectedLimitError() const { return aim().limit_error->expected(point_); }
  bool IsSoundForBilliard() const { return ballpiston::IsSoundForBilliard(spec_, point_); }
  Model ModelOfLimit() const { return aim().limit_error->model; }
  // Whether the limit's error can be judged, and is not beyond the tolerance.
  bool MayBeAnsweredByLimit() const {
    return HasLimitError() && HasRelativeError() &&
           (!target().tolerance || aim().limit_error->IsWithin(*target().tolerance, point_));
  }

  // The experiment, or the estimate if it is not the experiment's default.
  absl::string_view subject() const {
    const bool is_default = &aim() == &spec_.experiment->aims.front();
    return is_default ? spec_.experiment->name : aim().name;
  }

  // The model error of a billiard model: its error without the statistical error. Empty if the
  // first estimate has no relative error.
  std::optional<double> ErrorOfPrecision(Model model) const {
    if (EngineFor(By(model)) != Engine::kLanesSingle) return 0.0;
    if (!HasRelativeError()) return std::nullopt;
    return kSinglePrecisionError;
  }

  SamplingCost CostBy(Model model) const {
    return CostOfSampling(By(model), point_, machine_.rates);
  }
  double SecondsOf(Model model, double samples) const {
    return CostBy(model).Of(samples, machine_.workers) +
           spec_.experiment->summary * machine_.rates.jump;
  }
  double ThreadsFor(Model model, double samples) const {
    return CostBy(model).ThreadsFor(samples, machine_.workers);
  }
  // Of processor time, until all workers have their first samples.
  double SecondsOfTheFirst(Model model) const {
    return TakesSamples(model) ? CostBy(model).OfTheFirst(machine_.workers) : 0;
  }
  // The same by the model that answers: the least budget.
  double SecondsOfTheFirst() const {
    if (spec_.model != Model::kAuto) return SecondsOfTheFirst(spec_.model);
    if (!IsSoundForBilliard()) return SecondsOfTheFirst(ModelOfLimit());
    const double by_billiard = SecondsOfTheFirst(Model::kBilliard);
    return MayBeAnsweredByLimit() ? std::min(by_billiard, SecondsOfTheFirst(ModelOfLimit()))
                                  : by_billiard;
  }
  double MemoryBy(Model model) const { return MemoryOf(By(model), point_, machine_.workers); }

  // The number of samples that the target requires from a model that samples, without those of a
  // warm-up.
  double SamplesBy(Model model) const {
    const auto experiment = PointExperiment::Create(By(model), 0);
    const ChunkPlan& plan = experiment->plan();
    double samples =
        static_cast<double>(plan.SamplesBefore(experiment->expected_chunks()) - plan.warm_up());
    if (target().budget_seconds) samples = std::min(samples, SamplesInBudget(model));
    return samples;
  }

  // 0 if the budget ends before the first samples.
  double SamplesInBudget(Model model) const {
    const double seconds = BudgetOfAPoint(spec_, machine_.workers);
    return CostBy(model).SamplesIn(seconds, machine_.workers);
  }

  // Or needs none.
  bool LimitHasSamplesInBudget() const {
    return !TakesSamples(ModelOfLimit()) || SamplesInBudget(ModelOfLimit()) > 0;
  }

  double SamplesFor(double tolerance) const {
    return ballpiston::SamplesFor(tolerance, spec_, point_);
  }

  // Infinite if so many samples have no error.
  double ErrorOf(Model model, double samples) const {
    if (samples < aim().SamplesForAnError(model, point_)) {
      return std::numeric_limits<double>::infinity();
    }
    return aim().error(model, point_) / std::sqrt(samples);
  }
  bool HasRelativeError() const { return std::isfinite(aim().error(Model::kBilliard, point_)); }

  // The statistical error when the budget is used up; 0 for the spectrum, which has no samples.
  double ErrorInBudget(Model model) const {
    return model == Model::kSpectrum ? 0 : ErrorOf(model, SamplesInBudget(model));
  }

 private:
  EnsembleSpec By(Model model) const { return OnePointSpec(spec_, point_, model); }

  EnsembleSpec spec_;  // of this point alone
  PointParameters point_;
  Machine machine_;
};

// ---- the choice of the model ----

// The costs of a pilot and of the billiard itself, in wall hits. They are not in seconds, so that
// every machine makes the same choice.
double HitsOf(const PointParameters& point, double orbits) {
  constexpr double kHitsThatACollisionCosts = 100;
  const SampleWork work = kEnergyRelaxation.work(Model::kBilliard, point);
  return orbits * (work.ball_wall + kHitsThatACollisionCosts * work.collisions);
}

// A few hours of a core. Where the discs nearly touch, a pilot may take longer than any machine
// lasts.
constexpr double kMostHitsOfAPilot = 1e13;

double HitsOfPilot(const PilotPlace& place) {
  return HitsOf(PointOf(place), static_cast<double>(kPilotOrbits));
}

// The billiard as the answer; `why` is the reason that no cheaper model answers.
Answer Billiard(const Question& question, absl::string_view why) {
  const std::optional<double> error = question.ErrorOfPrecision(Model::kBilliard);
  return {Model::kBilliard, absl::StrCat(error == 0 ? "exact; " : kInSinglePrecision, why), error};
}

// The reason why no pilot is needed; empty if a pilot is needed.
std::string WithoutAPilot(const Question& question) {
  const double tolerance = *question.target().tolerance;
  const PilotPlace place = PilotPlaceFor(question.point());
  const double expected = question.ExpectedLimitError();
  if (expected > tolerance) {
    return absl::StrCat("the limit's error, up to ", Rounded(expected),
                        ", is beyond the tolerance");
  }
  const Pilot predicted = PredictedPilot(place);
  const Pilot at_best = {.difference = 0, .standard_error = predicted.standard_error};
  if (LimitErrorBound(at_best, place, question.point()) > tolerance) {
    return "a pilot could not establish the limit's error to this tolerance";
  }
  if (HitsOf(question.point(), question.SamplesFor(tolerance)) < HitsOfPilot(place)) {
    return "the billiard reaches the tolerance before a pilot would establish the limit's error";
  }
  return "";
}

std::string FoundBy(const Pilot& pilot, const PilotPlace& place) {
  return absl::StrCat(
      pilot.predicted ? "expected of a pilot at delta = " : "two sigma of a pilot at delta = ",
      Rounded(place.delta));
}

// If the limit's model samples, its error must be within half of the tolerance, so that the scatter
// is the larger part.
Answer ByItsBound(const Question& question) {
  const bool samples = TakesSamples(question.ModelOfLimit());
  const double error = question.ExpectedLimitError();
  const bool is_within = question.MayBeAnsweredByLimit();
  const std::string why = absl::StrCat("the limit's error, up to ", Rounded(error), ", is ",
                                       is_within ? "within " : "beyond ",
                                       samples ? "half of the tolerance" : "the tolerance");
  if (!is_within) return Billiard(question, why);
  return {question.ModelOfLimit(), why, error};
}

std::optional<Answer> ByTolerance(const Question& question, const PilotSource& pilots) {
  if (!question.HasPilots()) return ByItsBound(question);
  if (const std::string why = WithoutAPilot(question); !why.empty()) {
    return Billiard(question, why);
  }
  const PilotPlace place = PilotPlaceFor(question.point());
  if (HitsOfPilot(place) > kMostHitsOfAPilot) return ByItsBound(question);
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
Answer ByBudget(const Question& question) {
  if (!question.MayBeAnsweredByLimit()) return ByItsBound(question);
  const double bound = question.ExpectedLimitError();
  const double limit = question.ErrorInBudget(question.ModelOfLimit()) + bound;
  const double billiard = question.ErrorInBudget(Model::kBilliard) +
                          question.ErrorOfPrecision(Model::kBilliard).value_or(0);
  const std::string compared = absl::StrCat(
      std::isfinite(billiard)
          ? absl::StrCat("the billiard's error with this budget is about ", Rounded(billiard))
          : "the billiard has no error within this budget",
      ", the limit's ",
      std::isfinite(limit) ? absl::StrCat("error at most ", Rounded(limit))
                           : absl::StrCat("model error at most ", Rounded(bound)));
  const double enough = question.target().tolerance.value_or(0);
  const bool is_by_billiard = std::isfinite(billiard) ? billiard <= std::max(limit, enough)
                                                      : !question.LimitHasSamplesInBudget();
  if (is_by_billiard) return Billiard(question, compared);
  return {question.ModelOfLimit(), compared, bound};
}

// Outside of the billiard's domain the limit answers by its expected error, without a pilot, if a
// tolerance permits it, or with a budget. Requires a known error.
bool MayAnswerWithoutBilliard(const Question& question) {
  const Target& target = question.target();
  if (question.IsSoundForBilliard()) return false;
  if (!target.tolerance) return target.budget_seconds.has_value();
  return question.aim().limit_error->IsWithin(*target.tolerance, question.point());
}

Answer WithoutBilliard(const Question& question) {
  return {question.ModelOfLimit(), "the billiard is not sound at this rho and delta",
          question.ExpectedLimitError()};
}

std::optional<Answer> AnswerNearTheLimit(const Question& question, const PilotSource& pilots) {
  if (!question.HasLimitError()) {
    return Billiard(question, "the limit's error is not known at this point");
  }
  if (MayAnswerWithoutBilliard(question)) return WithoutBilliard(question);
  if (!question.HasRelativeError()) {
    return Billiard(question,
                    "the first estimate has no relative error at this point, so the limit's error "
                    "cannot be judged");
  }
  if (question.target().budget_seconds) return ByBudget(question);
  if (question.target().tolerance) return ByTolerance(question, pilots);
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

Answer ExplicitAnswer(const Question& question) {
  const Model model = question.spec().model;
  if (!IsOfTheLimit(model)) return {model, "", question.ErrorOfPrecision(model)};
  if (!question.HasLimitError()) return {model, "", std::nullopt};
  return {model, "", question.ExpectedLimitError()};
}

// ---- all rungs ----

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
  const double error = question.ErrorOf(rung.model, *rung.samples);
  if (std::isfinite(error)) rung.statistical_error = error;
}

// The limit's error: from the pilot that the choice has used, else the expected error.
void SetLimitError(const Question& question, const std::optional<Pilot>& pilot, Rung& rung) {
  rung.reason = "the limit delta -> 0";
  if (!question.HasLimitError()) return;
  rung.model_error = question.ExpectedLimitError();
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

namespace {

// The limit's errors in other estimates of the answer.
void AddFurtherErrors(const Question& question, Answer& answer) {
  if (!IsOfTheLimit(answer.model)) return;
  for (const AimedEstimate& aim : question.spec().experiment->aims) {
    if (aim.limit_error == nullptr || !aim.limit_error->is_known(question.point())) continue;
    const bool is_first = &aim == &question.aim();
    const double error =
        is_first ? answer.model_error.value_or(0) : aim.limit_error->expected(question.point());
    if (!is_first) answer.further_errors.emplace(aim.name, error);
    for (const absl::string_view name : aim.multiples) answer.further_errors.emplace(name, error);
  }
}

}  // namespace

double BudgetOfAPoint(const EnsembleSpec& spec, int workers) {
  return *spec.target.budget_seconds * workers / static_cast<double>(PointCount(spec));
}

std::optional<Answer> ChooseAnswer(const EnsembleSpec& spec, const PointParameters& point,
                                   const Machine& machine, const PilotSource& pilots) {
  const Question question(spec, point, machine);
  std::optional<Answer> answer =
      spec.model == Model::kAuto ? AutoAnswer(question, pilots) : ExplicitAnswer(question);
  if (answer) AddFurtherErrors(question, *answer);
  return answer;
}

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

namespace {

// The largest model error of any point, if a pilot can check it. For a model that samples, at least
// the statistical error of the largest permitted number of samples.
double LeastTolerance(const EnsembleSpec& spec) {
  if (IsAnsweredByClosedForm(spec)) return kClosedFormError;
  double least = 0;
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const PointParameters point = PointAt(spec, i);
    const Question question(spec, point, Machine());
    const bool is_checked = question.HasPilots() || spec.model == Model::kSpectrum;
    if (IsOfTheLimit(spec.model) && question.HasLimitError() && is_checked) {
      least = std::max(least, question.ExpectedLimitError());
    }
    if (spec.model == Model::kSpectrum) continue;
    least = std::max(least, question.ErrorOfPrecision(spec.model).value_or(0));
    const double sampled = question.ErrorOf(Sampled(spec.model), static_cast<double>(kMaxSamples));
    if (std::isfinite(sampled)) least = std::max(least, sampled);
  }
  return least;
}

// The model that is expected to answer, without pilots.
Model ExpectedModel(const EnsembleSpec& spec, const PointParameters& point) {
  if (spec.model != Model::kAuto) return spec.model;
  return ChooseAnswer(spec, point, Machine(), PredictedPilot)->model;
}

// The names and values of the parameters of a point.
std::string ParametersText(const PointParameters& point) {
  std::string text;
  for (const Parameter* parameter : kParameters) {
    const auto& value = point.Find(*parameter);
    if (!value) continue;
    absl::StrAppend(&text, text.empty() ? "" : ", ", parameter->name, " = ",
                    parameter == &kCells ? Text(ShapeOf(*value)) : NumberText(*value));
  }
  return text;
}

// A point where a relative error is out of reach: of an estimate that has none, or because the
// largest permitted number of samples has no error. The first one.
std::vector<FieldViolation> PointsWithoutAnError(const EnsembleSpec& spec) {
  const AimedEstimate& aim = AimOf(spec);
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const PointParameters point = PointAt(spec, i);
    const Model model = ExpectedModel(spec, point);
    if (model == Model::kClosedForm) continue;
    const double needed = TakesSamples(model) ? aim.SamplesForAnError(model, point) : 0;
    const bool has_error = std::isfinite(aim.error(model, point)) && std::isfinite(needed);
    if (has_error && needed <= static_cast<double>(kMaxSamples)) continue;
    const std::string reason =
        has_error ? absl::StrFormat(
                        "an error needs %.2g samples, because the events that determine "
                        "the mean are rare; permitted in this case: samples, up to %d",
                        needed, kMaxSamples)
                  : absl::StrCat("no number of samples gives ", aim.name,
                                 " a relative error: ", aim.no_error);
    return {{"target.tolerance",
             absl::StrFormat("is %s, but at %s %s", NumberText(*spec.target.tolerance),
                             ParametersText(point), reason)}};
  }
  return {};
}

FieldViolation TooLong(const EnsembleSpec& spec, const PointParameters& point, double seconds) {
  const Target& target = spec.target;
  std::string field = "target.samples";
  std::string given = absl::StrCat("is ", kDefaultSamples, " by default");
  if (target.samples) given = absl::StrCat("is ", *target.samples);
  if (target.collisions) {
    field = "target.collisions", given = absl::StrCat("is ", *target.collisions);
  }
  if (target.tolerance) {
    field = "target.tolerance", given = absl::StrCat("is ", NumberText(*target.tolerance));
  }
  return {field,
          absl::StrFormat("%s, which takes about %.1g s of one core at %s; permitted: up to %.0g s",
                          given, seconds, ParametersText(point), kMostSeconds)};
}

}  // namespace

std::vector<FieldViolation> TimeViolations(const EnsembleSpec& spec) {
  if (NeedsNoSamples(spec) || spec.target.budget_seconds) return {};
  for (size_t i = 0; i < PointCount(spec); ++i) {
    const PointParameters point = PointAt(spec, i);
    // Without a tolerance AUTO takes samples of the billiard.
    const Model model = spec.target.tolerance ? ExpectedModel(spec, point) : Sampled(spec.model);
    if (!TakesSamples(model)) continue;
    const double seconds = NominalSeconds(OnePointSpec(spec, point, model), point);
    if (!(seconds <= kMostSeconds)) return {TooLong(spec, point, seconds)};
  }
  return {};
}

namespace {

std::string Megabytes(double bytes) { return absl::StrFormat("%.0f MB", std::ceil(bytes / 1e6)); }

// Only gases need much memory, and only their shape matters.
void CheckMemory(const EnsembleSpec& spec, const Machine& machine,
                 std::vector<FieldViolation>& found) {
  const std::vector<double>& cells = spec.grid[kCells];
  for (size_t i = 0; i < cells.size(); ++i) {
    PointParameters point = PointAt(spec, 0);
    point.Set(kCells, cells[i]);
    const double needed = MemoryOf(spec, point, 1);
    if (needed <= machine.memory) continue;
    found.push_back(
        {absl::StrFormat("grid.cells[%d]", i),
         absl::StrFormat("is %s, which needs %s of memory; permitted here: up to %s",
                         Text(ShapeOf(cells[i])), Megabytes(needed), Megabytes(machine.memory))});
  }
}

void CheckBudget(const EnsembleSpec& spec, const Machine& machine,
                 std::vector<FieldViolation>& found) {
  if (!spec.target.budget_seconds || NeedsNoSamples(spec)) return;
  const double budget = BudgetOfAPoint(spec, machine.workers);
  double least = 0;  // processor time of a point
  for (size_t i = 0; i < PointCount(spec); ++i) {
    least = std::max(least, Question(spec, PointAt(spec, i), machine).SecondsOfTheFirst());
  }
  if (least <= budget) return;
  const double seconds = *spec.target.budget_seconds * least / budget;
  const auto points = static_cast<int64_t>(PointCount(spec));
  found.push_back(
      {"target.budget",
       absl::StrFormat("is %s s%s, which ends before the first samples are complete; permitted on "
                       "this server: budget >= %s s",
                       NumberText(*spec.target.budget_seconds),
                       points == 1 ? "" : absl::StrFormat(" for %d points", points),
                       RoundedUp(seconds))});
}

}  // namespace

std::vector<FieldViolation> MachineViolations(const EnsembleSpec& spec, const Machine& machine) {
  std::vector<FieldViolation> found;
  CheckMemory(spec, machine, found);
  CheckBudget(spec, machine, found);
  return found;
}

std::vector<FieldViolation> DomainViolations(const EnsembleSpec& spec) {
  std::vector<FieldViolation> found;
  if (spec.model != Model::kAuto) return found;
  for (size_t i = 0; i < PointCount(spec) && found.empty(); ++i) {
    const PointParameters point = PointAt(spec, i);
    if (IsSoundForBilliard(spec, point) || !IsABilliard(ExpectedModel(spec, point))) continue;
    EnsembleSpec by_billiard = spec;
    by_billiard.model = Model::kBilliard;
    CheckBilliardDomain(by_billiard, found);
  }
  return found;
}

std::vector<FieldViolation> ToleranceViolations(const EnsembleSpec& spec) {
  if (!spec.target.tolerance) return {};
  if (std::vector<FieldViolation> found = PointsWithoutAnError(spec); !found.empty()) return found;
  const double tolerance = *spec.target.tolerance, least = LeastTolerance(spec);
  if (!(tolerance < least)) return {};
  absl::string_view other;
  if (IsOfTheLimit(spec.model)) other = ", or model auto or billiard";
  if (spec.precision == Precision::kSingle) other = ", or precision double";
  return {{"target.tolerance",
           absl::StrCat("is ", NumberText(tolerance), ", below what model ", Name(spec.model),
                        " can reach; permitted: tolerance >= ", RoundedUp(least), other)}};
}

}  // namespace ballpiston
