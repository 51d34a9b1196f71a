#include "core/experiment/ingoing_cells.h"

#include "core/arithmetic/elementary_functions.h"

namespace ballpiston {

std::vector<Histogram> EmptyIngoingHistograms(const IngoingLaw& law) {
  std::vector<Histogram> histograms;
  for (const int sigma : kIngoingSigmas) {
    const double half_width = law.AlphaMax(sigma);
    if (half_width == 0) continue;
    histograms.push_back(Histogram::OfBins(-half_width, half_width, kIngoingBins));
  }
  return histograms;
}

std::vector<std::vector<double>> IngoingBinProbabilities(const IngoingLaw& law) {
  std::vector<std::vector<double>> probabilities;
  for (const Histogram& histogram : EmptyIngoingHistograms(law)) {
    const int sigma = kIngoingSigmas[probabilities.size()];
    std::vector<double>& bins = probabilities.emplace_back(kIngoingBins);
    for (size_t bin = 0; bin < kIngoingBins; ++bin) {
      bins[bin] = law.BinProbability(sigma, histogram.Edge(bin), histogram.Edge(bin + 1));
    }
  }
  return probabilities;
}

void CountIngoing(const Return& hit, std::span<Histogram> histograms) {
  // With epsilon >= 1/4 an approaching piston always moves to the left. If rounding says otherwise,
  // the hit still counts as sigma = -1.
  const size_t index = hit.sigma > 0 && histograms.size() > 1 ? 1 : 0;
  histograms[index].Add(Atan2(hit.direction.y(), hit.direction.x()));
}

}  // namespace ballpiston
