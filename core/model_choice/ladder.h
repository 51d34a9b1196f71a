// The ladder of models: the models that can answer, their costs and errors, and the choice.
//
// Costs and errors refer to the estimate that the target names (experiment_kind.h: AimedEstimate).
// AUTO chooses the cheapest model that is exact for this estimate, or whose error has an upper
// bound within the tolerance (within half of it if the model samples). This is a closed form if
// there is one, else the limit's cheapest model if its bound permits (experiment_kind.h:
// AimedEstimate::limit_error), else the billiard. Without a tolerance AUTO chooses only an exact
// model. With a budget alone AUTO chooses the model with the smallest error that can be reached
// within the budget.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/ensemble/point_experiment.h"
#include "core/model_choice/machine_rates.h"

namespace ballpiston {

// The machine for which costs are predicted.
struct Machine {
  MachineRates rates;
  int workers = 1;
  double memory = std::numeric_limits<double>::infinity();  // bytes that questions may use
};

// The model that answers at a point; for AUTO the service's choice. Without a budget the choice
// depends on the spec alone, not on the machine. The spec must have no violations.
Answer ChooseAnswer(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine);

struct Rung {
  Model model = Model::kBilliard;
  bool answers = false;
  std::string reason;             // why it cannot answer, or the source of its error
  std::optional<double> samples;  // that the target requires
  std::optional<double> work;     // seconds of processor time
  double time = 0;                // seconds by the clock, if all workers have only this point
  std::optional<double> statistical_error;  // these two relative, of the first estimate
  std::optional<double> model_error;
  double memory = 0;  // bytes
};

struct Ladder {
  std::vector<Rung> rungs;  // cheapest first
  Answer answer;

  const Rung& Chosen() const;
};

Ladder LadderFor(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine);

// No machine computes longer for a point than this, in seconds at nominal speed.
inline constexpr double kMostSeconds = 1e10;

// Finds what the answering model cannot do. The spec must have no violations. The first of these:
//   rho, delta or epsilon outside of the billiard's domain (billiard/billiard_domain.h), if AUTO
//     has to choose the billiard at a point outside of it
//   a tolerance that the model cannot reach: below the model's own error, or below the statistical
//     error of the largest permitted number of samples, or where the estimate has no relative
//     error. The limit's error counts for the spectrum; the tolerance of `markov` is that of its
//     samples
//   a point that takes longer than kMostSeconds. A budget limits the time of each point
std::vector<FieldViolation> AnswerViolations(const EnsembleSpec& spec);

// Finds what this machine cannot do: a question that needs more memory, and a budget that ends
// before the first samples of a point. The spec must have no other violations.
std::vector<FieldViolation> MachineViolations(const EnsembleSpec& spec, const Machine& machine);

// Processor time of a budget for each point of the grid.
double BudgetOfAPoint(const EnsembleSpec& spec, int workers);

}  // namespace ballpiston
