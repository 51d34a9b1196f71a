// Predicts the cost of samples on a machine, from the work that the experiment's row counts and the
// machine's rates. The prediction holds within a factor of five, mostly within two.
#pragma once

#include "core/ensemble/ensemble_spec.h"
#include "core/model_choice/machine_rates.h"

namespace ballpiston {

// Seconds of processor time. All lanes of a thread fly even if few have orbits. So a few samples
// cost as much as the longest of them in all lanes, and at the end of many samples the last orbits
// fly in lanes that are hardly full.
struct SamplingCost {
  double sample = 0;   // one of many samples
  double flight = 0;   // the part of it that lanes compute together
  double lanes = 1;    // orbits that a thread computes at the same time
  double orbit = 1;    // samples of an orbit
  double parts = 1;    // of a sample's flight (ensemble/experiment_kind.h)
  double first = 0;    // a thread's time until its first samples are complete
  double warm_up = 0;  // the time of samples that are not measured, of all threads
  double stage = 0;    // the first samples that are complete, where they continue each other

  // `samples` samples by up to `threads` threads, after the warm-up.
  double Of(double samples, int threads) const;
  // Until all of up to `threads` threads have their first samples.
  double OfTheFirst(int threads) const;
  // The number of threads that have samples then.
  double ThreadsFor(double samples, int threads) const;
  // The number of samples that `threads` threads complete in this time; 0 if they complete none.
  double SamplesIn(double seconds, int threads) const;
};

// By a model that samples (spec.model; AUTO is the billiard).
SamplingCost CostOfSampling(const EnsembleSpec& spec, const PointParameters& point,
                            const MachineRates& rates);

}  // namespace ballpiston
