// How far a table of counts is from the uniform law: relative entropies, with the noise floors of
// core/statistics/kl_divergence.h, from logarithms whose bits no processor changes. A row of the
// table is a histogram; all have the same bins.
//
//   DivergenceFromUniform        all cells of the table equally probable
//   DivergenceWithinRows         cells of one row equally probable, rows filled anyhow:
//       sum over rows of (share of the row) (relative entropy of the row to the uniform law)
// The second asks whether the column is uniform and independent of the row. Its noise floor is
// right also if rows follow each other as a Markov chain does, as long as each column is drawn
// afresh; that of a table with the rows' probabilities in it would not be.
//
// Property, with a test of its name: 1. NoiseFloorsHoldForTheJumpProcess.
#ifndef BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_DIVERGENCE_H_
#define BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_DIVERGENCE_H_

#include <span>

#include "core/statistics/histogram.h"
#include "core/statistics/kl_divergence.h"

namespace ballpiston {

// Both require at least one sample.
KlDivergence DivergenceFromUniform(std::span<const Histogram> rows);

// Of its result `cells` counts those that are free: rows x (bins - 1), of rows that have samples,
// and one more, as the noise floor wants it.
KlDivergence DivergenceWithinRows(std::span<const Histogram> rows);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_DIVERGENCE_H_
