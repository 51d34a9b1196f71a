#include "core/experiment/first_hit.h"

#include <utility>

#include "core/experiment/ingoing_cells.h"
#include "core/experiment/predicted_hits.h"
#include "core/experiment/return_orbits.h"
#include "core/statistics/told_error.h"

namespace ballpiston {
namespace {

void Record(const Return& hit, BlockResult* result) {
  ++result->samples;
  result->moments[0].Add(hit.time);
  result->moments[1].Add(hit.direction.x());
  result->moments[2].Add(hit.sigma);
  CountIngoing(hit, result->histograms);
}

KlDivergence RelativeEntropyTo(const std::vector<SignedHistogram>& histograms) {
  std::vector<uint64_t> counts;
  std::vector<double> probabilities;
  for (const SignedHistogram& h : histograms) {
    counts.insert(counts.end(), h.histogram.counts.begin(), h.histogram.counts.end());
    probabilities.insert(probabilities.end(), h.expected_probabilities.begin(),
                         h.expected_probabilities.end());
  }
  return RelativeEntropy(counts, probabilities);
}

Estimate MeanCosAlpha(const Moments& moments) {
  const double samples = static_cast<double>(moments.count);
  return {.name = "mean_cos_alpha",
          .value = moments.mean,
          .standard_error = ToldError(samples, moments.StandardError())};
}

// Of +1 and -1; where only -1 is possible, it is that.
Estimate MeanSigma(const Moments& moments, bool fluctuates) {
  const double of_both_signs =
      static_cast<double>(moments.count) * (1 - moments.mean * moments.mean);
  return {.name = "mean_sigma",
          .value = moments.mean,
          .standard_error =
              fluctuates ? ToldError(of_both_signs, moments.StandardError()) : std::optional(0.0)};
}

}  // namespace

FirstHitExperiment::FirstHitExperiment(const EnsembleSpec& spec, const PointParameters& point,
                                       const PairGeometry& geometry)
    : PointExperiment(spec, point,
                      PlanBlocks(spec, HitsPerReturn(geometry, *point.epsilon).Events())),
      geometry_(geometry),
      equilibrium_(*point.epsilon),
      return_time_(geometry, *point.epsilon),
      expected_(IngoingBinProbabilities(equilibrium_)) {}

BlockResult FirstHitExperiment::EmptyResult() const {
  BlockResult result;
  result.moments.resize(3);
  result.histograms = EmptyIngoingHistograms(equilibrium_);
  return result;
}

std::optional<BlockResult> FirstHitExperiment::RunBlock(uint64_t block,
                                                        std::stop_token stop) const {
  ReturnOrbits orbits(geometry_, {*parameters().epsilon, *parameters().exponent}, random(),
                      plan().FirstSample(block), plan().SamplesIn(block));
  if (!RunOrbits(engine(), geometry_, plan().SamplesIn(block), orbits, stop)) return std::nullopt;
  BlockResult result = EmptyResult();
  for (const Return& sample : orbits.returns()) {
    if (Healthy(sample, result.health)) Record(sample, &result);
  }
  return result;
}

std::vector<SignedHistogram> FirstHitExperiment::LabelledHistograms(
    const BlockResult& merged) const {
  std::vector<SignedHistogram> labelled;
  for (size_t i = 0; i < merged.histograms.size(); ++i) {
    labelled.push_back({"alpha", kIngoingSigmas[i], merged.histograms[i], expected_[i]});
  }
  return labelled;
}

Estimate FirstHitExperiment::FirstEstimate(const BlockResult& merged) const {
  Estimate mean = return_time_.Mean("mean_hit_time", merged.moments[0]);
  if (parameters().exponent == 1) mean.exact = return_time_.exact_mean();
  return mean;
}

PointSummary FirstHitExperiment::Summarize(const BlockResult& merged) const {
  PointSummary summary = {.samples = merged.samples, .health = merged.health};
  summary.estimates = {FirstEstimate(merged), MeanCosAlpha(merged.moments[1]),
                       MeanSigma(merged.moments[2], equilibrium_.AlphaMax(+1) > 0)};
  if (parameters().exponent == 1) {
    summary.estimates[1].exact = equilibrium_.MeanCosAlpha();
    summary.estimates[2].exact = equilibrium_.MeanSigma();
  }
  if (const auto variation = return_time_.CoefficientOfVariation(merged.moments[0])) {
    summary.estimates.push_back(*variation);
  }
  summary.histograms = LabelledHistograms(merged);
  if (merged.samples > 0) summary.kl_divergence = RelativeEntropyTo(summary.histograms);
  return summary;
}

}  // namespace ballpiston
