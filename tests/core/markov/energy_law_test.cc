#include "core/markov/energy_law.h"

#include "core/closed_form/kernel.h"
#include "core/markov/relaxation_spectrum.h"
#include "core/statistics/histogram.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr int kBins = 61;
constexpr double kEpsilons[] = {0,     0.03125, 0.125,    0.25,     0.251,
                                0.375, 0.49,    0.499127, 0.499962, 0.5};
constexpr double kTimes[] = {0, 0.01, 0.5, 2, 8, 16, 30};

double Edge(int bin) { return bin / (2.0 * kBins); }

const EnergyLaw& Fine() {
  static const EnergyLaw law(kEnergyLawDiscretisation, kBins);
  return law;
}

// The probability without a jump is at a single energy in its bin; the rest is spread over the
// bins.
TEST(EnergyLaw, MeanAgreesWithTheSpectrum) {
  const EnergyLaw narrow({.degree = 8, .levels = 4}, 256);
  for (const double epsilon : kEpsilons) {
    for (const double time : {0.5, 2.0, 8.0}) {
      const std::vector<double> p = narrow.Probabilities(narrow.From(epsilon), time);
      const double velocity = std::sqrt(2 * epsilon);
      const double start = std::min(std::floor(velocity * velocity * 256), 255.0) + 0.5;
      double mean = std::exp(-PairCollisionRate(epsilon) * time) * (epsilon - start / 512);
      for (size_t bin = 0; bin < p.size(); ++bin) {
        mean += p[bin] * (static_cast<double>(bin) + 0.5) / (2.0 * static_cast<double>(p.size()));
      }
      EXPECT_NEAR(mean, RelaxationSpectrum::Get().MeanEnergy(epsilon, time).value, 5e-4)
          << epsilon << " " << time;
    }
  }
}

// At short times the mass of a bin comes from a single jump: by the closed form of the kernel.
TEST(EnergyLaw, FollowsTheKernelAtShortTimes) {
  constexpr double kTime = 1e-4;
  for (const double epsilon : {0.03125, 0.125, 0.3, 0.4, 0.49}) {
    const KernelDistribution kernel(epsilon);
    const double rate = PairCollisionRate(epsilon);
    const std::vector<double> p = Fine().Probabilities(Fine().From(epsilon), kTime);
    const auto below = [&](double x) { return x < 0.5 - epsilon ? kernel.Below(x) : 1; };
    for (int bin = 0; bin < kBins; ++bin) {
      if (bin == static_cast<int>(2 * epsilon * kBins)) continue;
      const double jumps = rate * (below(Edge(bin + 1)) - below(Edge(bin)));
      // The second order is the rate times the time. The discretisation smooths the kernel's
      // singularity at the ball's energy, in the bins beside it.
      EXPECT_NEAR(p[static_cast<size_t>(bin)] / kTime, jumps, 0.02 * jumps + 2e-3)
          << epsilon << " " << bin;
    }
  }
}

// Samples have the energy of a velocity, which is rounded.
TEST(EnergyLaw, AnEnergyOnAnEdgeIsInTheBinOfItsSamples) {
  for (int bin = 0; bin <= kBins; ++bin) {
    const double epsilon = 0.5 * bin / kBins, velocity = std::sqrt(2 * epsilon);
    Histogram samples = Histogram::OfBins(0, 0.5, kBins);
    samples.Add(velocity * velocity / 2);
    const std::vector<double> law = Fine().Probabilities(Fine().From(epsilon), 0);
    for (size_t i = 0; i < law.size(); ++i) {
      EXPECT_NEAR(law[i], static_cast<double>(samples.counts[i]), kEnergyLawError) << epsilon;
    }
  }
}

// The finer law has one more level and bins of a third of the width, because a part of the error is
// that of rates within a bin. Both laws have the largest permitted degree, 20.
TEST(EnergyLaw, SumsToOneAndDiffersFromAFinerLawByLessThanItsBound) {
  const EnergyLaw finer({.degree = 20, .levels = 5}, 3 * kBins);
  for (const double epsilon : kEpsilons) {
    for (const double time : kTimes) {
      const std::vector<double> a = Fine().Probabilities(Fine().From(epsilon), time);
      const std::vector<double> b = finer.Probabilities(finer.From(epsilon), time);
      EXPECT_NEAR(std::accumulate(a.begin(), a.end(), 0.0), 1, 1e-14) << epsilon << " " << time;
      for (size_t bin = 0; bin < a.size(); ++bin) {
        EXPECT_GE(a[bin], 0) << epsilon << " " << time;
        const double exact = b[3 * bin] + b[3 * bin + 1] + b[3 * bin + 2];
        EXPECT_NEAR(a[bin], exact, epsilon < 0.45 ? 5e-5 : kEnergyLawError)
            << epsilon << " " << time;
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston
