// Predicts the cost of a sample on a machine, from the work that the experiment's row counts and
// the machine's rates. The prediction holds within a factor of two, except for the extra work of a
// slow ball or piston.
#ifndef BALLPISTON_CORE_MODEL_CHOICE_SAMPLING_COST_H_
#define BALLPISTON_CORE_MODEL_CHOICE_SAMPLING_COST_H_

#include "core/ensemble/ensemble_spec.h"
#include "core/model_choice/machine_rates.h"

namespace ballpiston {

// Seconds of processor time of one sample, by a model that samples (spec.model; AUTO is the
// billiard).
double SecondsPerSample(const EnsembleSpec& spec, const PointParameters& point,
                        const MachineRates& rates);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MODEL_CHOICE_SAMPLING_COST_H_
