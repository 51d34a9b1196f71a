// What a sample costs and how much it says, predicted.
//
// Costs from counted wall hits and a machine's rates; errors from the variance of one sample, by
// formulas fitted to samples at four radii and ten penetrations. Both hold within a factor of two,
// but for what a slow ball or piston does to the scatter.
#ifndef BALLPISTON_CORE_MODEL_CHOICE_SAMPLING_COST_H_
#define BALLPISTON_CORE_MODEL_CHOICE_SAMPLING_COST_H_

#include "core/experiment/ensemble_spec.h"
#include "core/geometry/pair_geometry.h"
#include "core/model_choice/machine_rates.h"

namespace ballpiston {

// Seconds of processor time of one sample, by a model that samples (spec.model; AUTO is the
// billiard).
double SecondsPerSample(const EnsembleSpec& spec, const PairGeometry& geometry,
                        const PointParameters& point, const MachineRates& rates);

// Standard error of the experiment's first estimate from one sample, relatively; of n it is
// 1/sqrt(n) times that. Infinite where no number of samples is enough, as for
// markov-property, which measures what tends to 0.
double RelativeErrorOfOneSample(Experiment experiment, const PairGeometry& geometry,
                                const PointParameters& point);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MODEL_CHOICE_SAMPLING_COST_H_
