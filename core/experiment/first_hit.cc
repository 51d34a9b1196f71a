#include "core/experiment/first_hit.h"

#include <utility>

#include "core/experiment/return_orbits.h"
#include "core/geometry/elementary_functions.h"

namespace ballpiston {
namespace {

constexpr int kSigmas[] = {-1, +1};  // by index of the histogram

void Record(const Return& hit, BlockResult* result) {
  ++result->samples;
  result->moments[0].Add(hit.time);
  result->moments[1].Add(hit.direction.x());
  result->moments[2].Add(hit.sigma);
  // With epsilon >= 1/4 an approaching piston always moves to the left; rounding may not add a law.
  const size_t index = hit.sigma > 0 && result->histograms.size() > 1 ? 1 : 0;
  result->histograms[index].Add(Atan2(hit.direction.y(), hit.direction.x()));
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

Estimate Mean(std::string name, const Moments& moments) {
  return {
      .name = std::move(name), .value = moments.mean, .standard_error = moments.StandardError()};
}

}  // namespace

FirstHitExperiment::FirstHitExperiment(const EnsembleSpec& spec, const PointParameters& point,
                                       const PairGeometry& geometry)
    : PointExperiment(spec, point, PlanBlocks(spec, EventsPerReturn(geometry, *point.epsilon))),
      geometry_(geometry),
      equilibrium_(*point.epsilon),
      return_time_(geometry, *point.epsilon),
      expected_(ExpectedProbabilities()) {}

BlockResult FirstHitExperiment::EmptyResult() const {
  BlockResult result;
  result.moments.resize(3);
  for (const int sigma : kSigmas) {
    const double half_width = equilibrium_.AlphaMax(sigma);
    if (half_width == 0) continue;
    result.histograms.push_back(Histogram::OfBins(-half_width, half_width, kIngoingBins));
  }
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

std::vector<std::vector<double>> FirstHitExperiment::ExpectedProbabilities() const {
  std::vector<std::vector<double>> expected;
  const BlockResult empty = EmptyResult();
  for (size_t i = 0; i < empty.histograms.size(); ++i) {
    const Histogram& histogram = empty.histograms[i];
    std::vector<double>& bins = expected.emplace_back(kIngoingBins);
    for (size_t bin = 0; bin < kIngoingBins; ++bin) {
      bins[bin] =
          equilibrium_.BinProbability(kSigmas[i], histogram.Edge(bin), histogram.Edge(bin + 1));
    }
  }
  return expected;
}

std::vector<SignedHistogram> FirstHitExperiment::LabelledHistograms(
    const BlockResult& merged) const {
  std::vector<SignedHistogram> labelled;
  for (size_t i = 0; i < merged.histograms.size(); ++i) {
    labelled.push_back({"alpha", kSigmas[i], merged.histograms[i], expected_[i]});
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
  summary.estimates = {FirstEstimate(merged), Mean("mean_cos_alpha", merged.moments[1]),
                       Mean("mean_sigma", merged.moments[2])};
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
