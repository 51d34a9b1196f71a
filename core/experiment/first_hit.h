// The paper's numerical test of the Markov property: start uniform on the collision surface with
// an outgoing law h^(n), and record the ingoing (alpha, sigma) of the first ball-piston collision.
//
// Moments: [0] hit time, [1] cos(alpha), [2] sigma. Histograms of alpha, 1000 bins over the
// interval allowed to each sign of the piston's velocity: [0] sigma = -1, [1] sigma = +1 (only for
// epsilon < 1/4). Their relative entropy to h^(1) is the paper's eq. kld. For n = 1 everything is
// stationary at every delta, and the exact values are given.
#ifndef BALLPISTON_CORE_EXPERIMENT_FIRST_HIT_H_
#define BALLPISTON_CORE_EXPERIMENT_FIRST_HIT_H_

#include "core/closed_form/ingoing_law.h"
#include "core/experiment/point_experiment.h"
#include "core/experiment/return_time.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

class FirstHitExperiment : public PointExperiment {
 public:
  FirstHitExperiment(const EnsembleSpec& spec, const PointParameters& point,
                     const PairGeometry& geometry);

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override;
  BlockResult EmptyResult() const override;
  Estimate FirstEstimate(const BlockResult& merged) const override;
  PointSummary Summarize(const BlockResult& merged) const override;

 private:
  std::vector<SignedHistogram> LabelledHistograms(const BlockResult& merged) const;

  PairGeometry geometry_;
  IngoingLaw equilibrium_;
  ReturnTime return_time_;
  std::vector<std::vector<double>> expected_;  // probabilities of the bins of each histogram
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_FIRST_HIT_H_
