#include "server/compute/model_ladder.h"

#include <string>

#include "core/ensemble/experiment_kind.h"
#include "core/experiment/all_experiments.h"
#include "core/markov/relaxation_spectrum.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/point_result.h"
#include "server/processor_time.h"
#include "server/store/point_tables.h"

namespace ballpiston::server {
namespace {

// An arbitrary pair.
constexpr double kAnyRho = 0.53, kAnyDelta = 0.1;

}  // namespace

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
  const auto experiment = Open(spec, 0);
  const PointSummary summary = experiment->Summarize(BlockResult());
  const PointRow row = {.result = DeterministicBytes(ResultOf(0, *experiment, summary)),
                        .details = DetailsBytes(DetailsOf(summary))};
  const auto told = std::make_shared<const std::string>(row.result);
  ThreadSeconds();
}

std::unique_ptr<const PointExperiment> ModelLadder::Open(const EnsembleSpec& spec, size_t index) {
  // Only a choice with a budget needs the machine's own rates.
  const Machine unmeasured = Unmeasured();
  const Machine& rates = spec.target.budget_seconds ? machine() : unmeasured;
  return PointExperiment::Create(spec, index, ChooseAnswer(spec, PointAt(spec, index), rates));
}

double ModelLadder::MemoryOf(const EnsembleSpec& spec, size_t index, int threads) {
  return ballpiston::MemoryOf(spec, PointAt(spec, index), threads);
}

}  // namespace ballpiston::server
