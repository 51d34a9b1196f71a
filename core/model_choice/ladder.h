// The ladder of models: which can answer, at what cost and with what error, and which one does.
//
// AUTO takes the cheapest model that is exact for what was asked, or whose error is established to
// be within the tolerance. A closed form where there is one; the spectrum where the limit's error
// allows it; else the billiard. Without a tolerance only what is exact will do; with a budget
// alone, whatever comes nearest in that time.
#ifndef BALLPISTON_CORE_MODEL_CHOICE_LADDER_H_
#define BALLPISTON_CORE_MODEL_CHOICE_LADDER_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/experiment/point_experiment.h"
#include "core/model_choice/limit_error.h"
#include "core/model_choice/machine_rates.h"

namespace ballpiston {

// What predictions are made for.
struct Machine {
  MachineRates rates;
  int workers = 1;
};

// Runs or recalls a pilot; nothing: told to stop.
using PilotSource = std::function<std::optional<Pilot>(const PilotPlace&)>;

// The model that answers at a point; for AUTO the service's choice. Without a
// budget a function of the spec alone, whatever the machine. Empty only if a pilot was needed and
// the source was told to stop. The spec has no violations.
std::optional<Answer> ChooseAnswer(const EnsembleSpec& spec, const PointParameters& point,
                                   const Machine& machine, const PilotSource& pilots);

struct Rung {
  Model model = Model::kBilliard;
  bool answers = false;
  std::string reason;                       // why not; or what its error is known from
  std::optional<double> samples;            // that the target takes
  std::optional<double> work;               // seconds of processor time
  std::optional<double> statistical_error;  // these two relative, of the first estimate
  std::optional<double> model_error;
};

struct Ladder {
  std::vector<Rung> rungs;  // cheapest first
  Answer answer;
  // What is to be run before the choice, by one worker, and its part of the chosen rung's work.
  std::optional<PilotPlace> pilot;
  double work_of_pilot = 0;

  const Rung& Chosen() const;
  Rung& Chosen();
  // Where another point runs it.
  void DropPilot();
};

// `pilots` gives what is known of a place; a pilot that was not run yet is predicted.
Ladder LadderFor(const EnsembleSpec& spec, const PointParameters& point, const Machine& machine,
                 const PilotSource& pilots);

// A tolerance that the answering model cannot reach: below its own error, or the error of all the
// samples that there can be.
std::vector<FieldViolation> ToleranceViolations(const EnsembleSpec& spec);

// Processor time that each point of the grid has of a budget.
double BudgetOfAPoint(const EnsembleSpec& spec, int workers);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MODEL_CHOICE_LADDER_H_
