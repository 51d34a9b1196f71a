#include "server/compute/model_ladder.h"

#include <string>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "core/engine_version.h"
#include "core/ensemble/experiment_kind.h"
#include "core/experiment/all_experiments.h"
#include "core/markov/relaxation_spectrum.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/processor_time.h"
#include "server/status/log.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

// An arbitrary pair.
constexpr double kAnyRho = 0.53, kAnyDelta = 0.1;

}  // namespace

ModelLadder::ModelLadder(Store& store, int workers, double memory)
    : store_(store), workers_(workers), memory_(memory) {}

const Machine& ModelLadder::machine() {
  std::call_once(measured_, [this] { Measure(); });
  return machine_;
}

void ModelLadder::Measure() {
  RelaxationSpectrum::Get();  // computed once, in 0.1 s; not part of a point's cost
  MachineRates rates = MeasureSamplingRates();
  const EnsembleSpec closed = {.experiment = &kEquilibrium,
                               .grid = {{kRho, {kAnyRho}}, {kDelta, {kAnyDelta}}}};
  EnsembleSpec spectrum = closed;
  spectrum.experiment = &kEnergyRelaxation;
  spectrum.model = Model::kSpectrum;
  rates.closed_form = SecondsOf([&] { Serve(closed); });
  rates.spectrum = SecondsOf([&] { Serve(spectrum); });
  machine_ = Unmeasured();
  machine_.rates = rates;
}

Machine ModelLadder::Unmeasured() const { return {MachineRates(), workers_, memory_}; }

std::vector<FieldViolation> ModelLadder::ViolationsHere(const EnsembleSpec& spec) {
  return MachineViolations(spec, spec.target.budget_seconds ? machine() : Unmeasured());
}

void ModelLadder::Serve(const EnsembleSpec& spec) {
  ThreadSeconds();  // a worker reads the clock twice
  const OpenedPoint opened = Open(spec, 0);
  const auto& experiment = *std::get<std::unique_ptr<const PointExperiment>>(opened);
  const PointSummary summary = experiment.Summarize(BlockResult());
  const PointRow row = {.result = DeterministicBytes(ResultOf(0, experiment, summary)),
                        .details = DetailsBytes(DetailsOf(summary))};
  const auto told = std::make_shared<const std::string>(row.result);
  ThreadSeconds();
}

OpenedPoint ModelLadder::Open(const EnsembleSpec& spec, size_t index) {
  std::optional<PilotPlace> needed;
  const PilotSource pilots = [&](const PilotPlace& place) {
    const std::optional<Pilot> known = Known(place);
    if (!known) needed = place;
    return known;
  };
  // Only a choice with a budget needs the machine's own rates.
  const Machine unmeasured = Unmeasured();
  const Machine& rates = spec.target.budget_seconds ? machine() : unmeasured;
  std::optional<Answer> answer = ChooseAnswer(spec, PointAt(spec, index), rates, pilots);
  if (!answer) return *needed;
  return PointExperiment::Create(spec, index, *std::move(answer));
}

double ModelLadder::MemoryOf(const EnsembleSpec& spec, size_t index, int threads) {
  return ballpiston::MemoryOf(spec, PointAt(spec, index), threads);
}

Ladder ModelLadder::LadderOf(const EnsembleSpec& spec, const PointParameters& point,
                             const std::set<PilotPlace>& planned) {
  return LadderFor(spec, point, machine(), [&](const PilotPlace& place) {
    return planned.contains(place) ? PredictedPilot(place) : Known(place);
  });
}

std::optional<Pilot> ModelLadder::Known(const PilotPlace& place) {
  {
    MutexLock lock(mutex_);
    const auto found = pilots_.find(place);
    if (found != pilots_.end()) return found->second;
  }
  const auto stored =
      store_.Read([&](Database& database) { return FindPilot(database, EngineVersion(), place); });
  if (!stored.ok()) {
    LogError(absl::StrCat("a pilot's result cannot be read: ", stored.status().message()));
  }
  if (!stored.ok() || !*stored) return std::nullopt;
  MutexLock lock(mutex_);
  return pilots_.emplace(place, **stored).first->second;
}

void ModelLadder::KeepPilot(const PilotPlace& place, const Pilot& pilot) {
  store_.Record(
      [place, pilot](Database& database) { InsertPilot(database, EngineVersion(), place, pilot); });
  MutexLock lock(mutex_);
  pilots_.emplace(place, pilot);
}

}  // namespace ballpiston::server
