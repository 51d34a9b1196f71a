#include "tools/stability/model_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/arithmetic/number_text.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "core/geometry/pair_geometry.h"
#include "core/model_choice/ladder.h"
#include "tools/flows/paper.h"
#include "tools/stability/markdown_table.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kSeedOfBilliard = 41;
constexpr uint64_t kSeedOfModel = 42;
// Samples of the jump process, for each of the billiard. They cost little.
constexpr int64_t kSamplesOfModel = 8;
constexpr int64_t kLeastSamples = 64;

// ---- the places ----

// A radius and a delta.
struct Cell {
  double rho;
  double delta;
};
Cell OfPair(double rho, double share) { return {rho, share * PairDeltaBound(rho)}; }
Cell OfGas(double rho, double share) { return {rho, share * GasDeltaBound(rho)}; }

// Near 1/2 tips are cusps. Nearer to 1/sqrt 2 than these radii a collision takes more wall hits, in
// inverse proportion to the size of the cell, and nothing else changes.
constexpr double kNearHalf = 0.50001;
constexpr double kSmallCell = 0.7;
constexpr double kSmallerCell = 0.705;
constexpr double kLargestSingle = 0.7061;  // nearly the largest radius for single precision

// A delta at which the jump process of the same shape stands for the billiard, which would take
// days: their difference falls as delta^2 log(1/delta), and is 1e-9 here. What is left is the
// difference of the gas's size.
constexpr double kRare = 1e-6;

class Places {
 public:
  // In equilibrium, or from each of the energies.
  void Relaxation(Model model, const Cell& cell, int64_t orbits,
                  const std::vector<double>& epsilons = {}) {
    const EnsembleSpec question = At(&kEnergyRelaxation, cell, orbits, model);
    if (epsilons.empty()) questions_.push_back(question);
    Add(question, ballpiston::kEpsilon, epsilons);
  }

  // With each of the cold reservoirs; the hot one has temperature 1. A sample is half a relaxation
  // time; `runs` are twelve relaxation times each.
  void Conduction(const Cell& cell, const char* cells, int64_t runs,
                  const std::vector<double>& colds) {
    EnsembleSpec question = At(&kGasConduction, cell, 24 * runs, Model::kMarkov);
    question.grid[kCells] = {CodeOf(*ParseGasShape(cells))};
    question.grid[kHot] = {1};
    Add(question, kCold, colds);
  }

  void Conductivity(Model model, const Cell& cell, const char* cells, int64_t replicas) {
    EnsembleSpec question = At(&kGasEquilibrium, cell, replicas, model);
    question.grid[kCells] = {CodeOf(*ParseGasShape(cells))};
    question.grid[kTemperature] = {1};
    question.target.estimate = "conductivity";
    questions_.push_back(question);
  }

  void SinglePrecision(const Cell& cell, int64_t returns) {
    EnsembleSpec question = At(&kConditionalMeanFreeTime, cell, returns, Model::kBilliard);
    question.precision = Precision::kSingle;
    Add(question, ballpiston::kEpsilon, {0.25});
  }

  const std::vector<EnsembleSpec>& questions() const { return questions_; }

 private:
  static EnsembleSpec At(const ExperimentKind* experiment, const Cell& cell, int64_t samples,
                         Model model) {
    return {.experiment = experiment,
            .grid = {{kRho, {cell.rho}}, {kDelta, {cell.delta}}},
            .target = {.samples = samples},
            .model = model};
  }

  void Add(EnsembleSpec question, const Parameter& parameter, const std::vector<double>& values) {
    for (const double value : values) {
      question.grid[parameter] = {value};
      questions_.push_back(question);
    }
  }

  std::vector<EnsembleSpec> questions_;
};

void AddRelaxation(Places& places) {
  const Cell paper{kPaperRho, 0.1};
  const auto add = [&](const Cell& cell, int64_t orbits, const std::vector<double>& epsilons = {}) {
    places.Relaxation(Model::kSpectrum, cell, orbits, epsilons);
  };
  for (const double delta : {0.3, 0.2, 0.1, 0.05}) add({kPaperRho, delta}, 65536);
  for (const double rho : {kNearHalf, 0.6, kSmallCell}) {
    for (const double share : {1.0, 0.3}) add(OfPair(rho, share), 8192);
  }
  add(OfPair(kSmallerCell, 1), 8192);
  for (const double rho : {kNearHalf, 0.501}) add({rho, 0.03}, 8192);
  add({kPaperRho, 0.3}, 8192, {0, 1e-5, 1e-3, 0.03, 0.12, 0.2, 0.45, 0.499, 0.49999, 0.5});
  add(paper, 16384, {0, 1e-7, 1e-5, 1e-3, 0.03, 0.12, 0.2, 0.3, 0.45, 0.49, 0.499, 0.49999, 0.5});
  for (const double rho : {kNearHalf, kSmallCell}) {
    add(OfPair(rho, 0.5), 16384, {1e-4, 0.01, 0.12, 0.3, 0.49, 0.4999});
  }
  add({0.5176, 0.0255}, 16384, {0.49995});  // the stroke is much shorter than the cell
  // The jump process, of which the spectrum is computed.
  places.Relaxation(Model::kMarkov, {kPaperRho, 0.2}, 65536);
  places.Relaxation(Model::kMarkov, OfPair(kNearHalf, 0.3), 8192);
  places.Relaxation(Model::kMarkov, OfPair(kSmallCell, 1), 8192);
  places.Relaxation(Model::kMarkov, paper, 16384, {1e-7, 0.45, 0.499});
}

void AddConduction(Places& places) {
  places.Conduction({kPaperRho, 0.2}, "1", 1024, {0.5, 0.1, 0.01, 1e-4, 1e-6});
  places.Conduction({kPaperRho, 0.1}, "1", 1024, {0.1, 0.01, 1e-3, 1e-4, 1e-6});
  places.Conduction({kPaperRho, 0.05}, "1", 512, {0.01, 1e-4});
  // At small delta the error is larger than in proportion to the delay.
  places.Conduction({0.515, 0.02}, "1", 2048, {1e-4});
  places.Conduction({kPaperRho, 0.02}, "2", 2048, {1e-4});
  places.Conduction({kPaperRho, 0.03}, "1", 512, {1e-4});
  places.Conduction({kPaperRho, 0.2}, "3", 256, {0.5, 0.01, 1e-4, 1e-6});
  places.Conduction({kPaperRho, 0.1}, "3", 256, {0.01, 1e-4});
  places.Conduction({kPaperRho, 0.2}, "8", 64, {1e-4});
  places.Conduction({kPaperRho, 0.2}, "2x2", 192, {0.01, 1e-4});
  for (const double rho : {kNearHalf, 0.6, kSmallCell}) {
    places.Conduction(OfGas(rho, 1), "1", 512, {0.5, 0.01, 1e-4});
    places.Conduction(OfGas(rho, 0.4), "1", rho == kSmallCell ? 192 : 512, {0.01, 1e-4});
  }
}

void AddConductivity(Places& places) {
  const auto add = [&](const Cell& cell, const char* cells, int64_t replicas) {
    places.Conductivity(Model::kSpectrum, cell, cells, replicas);
  };
  for (const char* cells : {"4", "1x1", "2x2"}) add({kPaperRho, 0.2}, cells, 20'000);
  add({kPaperRho, 0.1}, "4", 30'000);
  for (const double rho : {kNearHalf, 0.6}) add(OfGas(rho, 1), "2", 10'000);
  add(OfGas(kNearHalf, 0.4), "2", 10'000);
  add(OfGas(kSmallCell, 1), "2", 4'000);
  // As many as their errors need (EventsOfCurrents).
  add({kPaperRho, kRare}, "1", 1024);
  add({kPaperRho, kRare}, "2", 250'000);
  add({kPaperRho, kRare}, "2x1", 1024);
  for (const char* cells : {"4x1", "8x1", "4", "8x2"}) add({kPaperRho, kRare}, cells, 6000);
  places.Conductivity(Model::kMarkov, {kPaperRho, 0.2}, "4", 20'000);
  places.Conductivity(Model::kMarkov, {kPaperRho, 0.2}, "2x2", 20'000);
}

void AddSinglePrecision(Places& places) {
  for (const double rho : {kNearHalf, 0.65, kSmallCell}) {
    places.SinglePrecision(OfPair(rho, 1), 20'000'000);
  }
  places.SinglePrecision(OfPair(kLargestSingle, 1), 10'000'000);
}

// ---- a measurement ----

Estimate FirstEstimate(EnsembleSpec spec, uint64_t seed) {
  spec.seed = seed;
  const auto experiment = PointExperiment::Create(spec, 0);
  return experiment->Summarize(FoldPoint(*experiment)).estimates.front();
}

// The value from which the model's error counts, and its standard error.
Estimate Reference(const EnsembleSpec& question, const Estimate& by_model) {
  if (question.precision == Precision::kSingle && by_model.exact) {
    return {.name = by_model.name, .value = *by_model.exact, .standard_error = 0};
  }
  EnsembleSpec billiard = question;
  billiard.model = question.grid[kDelta].front() > kRare ? Model::kBilliard : Model::kMarkov;
  billiard.precision = Precision::kDouble;
  return FirstEstimate(billiard, kSeedOfBilliard);
}

}  // namespace

double ModelError::Stated() const {
  return *ChooseAnswer(question, PointAt(question, 0), Machine()).model_error;
}

double ModelError::Ratio() const { return (std::fabs(difference) - 2 * standard_error) / Stated(); }

bool ModelError::IsTight() const {
  const double noise = question.precision == Precision::kSingle ? 2 * standard_error : 0;
  return Stated() <= 4 * std::max(std::fabs(difference), noise);
}

std::vector<EnsembleSpec> ModelErrorQuestions() {
  Places places;
  AddRelaxation(places);
  AddConduction(places);
  AddConductivity(places);
  AddSinglePrecision(places);
  return places.questions();
}

std::string ClaimOf(const EnsembleSpec& question) {
  const bool is_single = question.precision == Precision::kSingle;
  const bool is_decay =
      question.experiment == &kEnergyRelaxation && !question.grid[ballpiston::kEpsilon].empty();
  return absl::StrCat(AimOf(question).name, is_decay ? " from an energy" : "", " by ",
                      is_single ? "billiard in single precision" : Name(question.model));
}

std::string PlaceOf(const EnsembleSpec& question) {
  std::vector<std::string> parts;
  for (const Parameter* parameter : kParameters) {
    if (question.grid[*parameter].empty()) continue;
    const double value = question.grid[*parameter].front();
    parts.push_back(absl::StrCat(parameter->name, " ",
                                 parameter == &kCells ? Text(ShapeOf(value)) : NumberText(value)));
  }
  return absl::StrJoin(parts, " ");
}

ModelError MeasuredModelError(const EnsembleSpec& question, double effort) {
  EnsembleSpec fewer = question;
  const auto samples = static_cast<double>(*question.target.samples) * effort;
  fewer.target.samples = std::max(static_cast<int64_t>(samples), kLeastSamples);
  EnsembleSpec of_model = fewer;
  if (IsOfTheLimit(question.model)) *of_model.target.samples *= kSamplesOfModel;
  const Estimate by_model = FirstEstimate(of_model, kSeedOfModel);
  const Estimate reference = Reference(fewer, by_model);
  const double ratio = reference.value / by_model.value;
  return {question, ratio - 1,
          std::fabs(ratio) * std::hypot(RelativeError(by_model), RelativeError(reference))};
}

std::vector<ModelError> ModelErrors() {
  std::vector<ModelError> errors;
  for (const EnsembleSpec& question : ModelErrorQuestions()) {
    std::cerr << "stability: " << ClaimOf(question) << ": " << PlaceOf(question) << std::endl;
    errors.push_back(MeasuredModelError(question, 1));
  }
  return errors;
}

std::vector<std::string> BrokenClaims(const std::vector<ModelError>& errors) {
  struct Count {
    int all = 0, tight = 0;
  };
  std::map<std::string, Count> claims;
  std::vector<std::string> broken;
  for (const ModelError& error : errors) {
    const std::string claim = ClaimOf(error.question);
    Count& count = claims[claim];
    if (!error.Counts()) continue;
    ++count.all;
    count.tight += error.IsTight();
    if (error.Ratio() <= 1) continue;
    broken.push_back(absl::StrFormat(
        "the stated error of %s, %.2g, does not cover %.2g +- %.2g: %s", claim, error.Stated(),
        error.difference, error.standard_error, PlaceOf(error.question)));
  }
  for (const auto& [claim, count] : claims) {
    if (count.all == 0) {
      broken.push_back(absl::StrFormat("no place counts for the stated error of %s", claim));
    }
    if (2 * count.tight >= count.all) continue;
    broken.push_back(absl::StrFormat(
        "the stated error of %s is more than four times the difference at %d of %d places", claim,
        count.all - count.tight, count.all));
  }
  return broken;
}

std::string ModelErrorTable(const std::vector<ModelError>& errors) {
  Rows rows = {
      {"claim", "place", "difference", "its standard error", "stated", "ratio", "at most 4 times"}};
  for (const ModelError& error : errors) {
    rows.push_back({ClaimOf(error.question), PlaceOf(error.question), SignedText(error.difference),
                    ErrorText(error.standard_error), ErrorText(error.Stated()),
                    error.Counts() ? absl::StrFormat("%.2f", error.Ratio()) : "-",
                    YesOrNo(error.IsTight())});
  }
  return MarkdownTable(rows, 2);
}

}  // namespace ballpiston::stability
