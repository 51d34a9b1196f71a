#include "core/markov/energy_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/arithmetic/gauss_nodes.h"
#include "core/closed_form/kernel.h"
#include "core/statistics/histogram.h"

namespace ballpiston {
namespace {

// Distance of a bin's two Gauss nodes from its ends, as a share of its width.
constexpr double kNode = 0.21132486540518713;
constexpr int kSetUpNodes = 16;

// From u = 1 all jumps go to u' = 0; this u avoids the division by 0.
constexpr double kFastest = 1 - 1e-12;

// A rate, and exp(-rate t), the part that remains after the time t of the law.
struct Decay {
  Decay(double rate, double t) : rate(rate), left(std::exp(-rate * t)) {}
  double rate, left;
};

// If two rates differ by less than this over t, a series is used, because the difference cancels.
constexpr double kClose = 1e-2;

// int_0^t exp(-a s - b (t - s)) ds
double TwoStages(const Decay& a, const Decay& b, double t) {
  const double x = (a.rate - b.rate) * t;
  if (std::fabs(x) < kClose) return t * std::sqrt(a.left * b.left) * (1 + x * x / 24);
  return (b.left - a.left) / (a.rate - b.rate);
}

// The integral over the durations of three stages. `ab` and `ac` are TwoStages(a, b, t) and
// TwoStages(a, c, t), which the callers have computed. The middle rate occurs in both terms of the
// difference. The relative error of the series is 4e-6.
double ThreeStages(const Decay& a, const Decay& b, const Decay& c, double ab, double ac, double t) {
  const auto [least, most] = std::minmax({a.rate, b.rate, c.rate});
  if ((most - least) * t < kClose) return t * t / 2 * std::cbrt(a.left * b.left * c.left);
  if ((b.rate - a.rate) * (c.rate - b.rate) >= 0) {
    return (ab - TwoStages(b, c, t)) / (c.rate - a.rate);
  }
  if ((a.rate - b.rate) * (c.rate - a.rate) >= 0) return (ab - ac) / (c.rate - b.rate);
  return (ac - TwoStages(b, c, t)) / (b.rate - a.rate);
}

// phi in v = s sin(phi); pi/2 for v > s, which no jump reaches.
double Angle(double v, double s) { return v < s ? std::asin(v / s) : std::numbers::pi / 2; }

std::vector<double> MiddleRates(size_t bins) {
  std::vector<double> rates(bins);
  for (size_t bin = 0; bin < bins; ++bin) {
    rates[bin] =
        PairCollisionRate((static_cast<double>(bin) + 0.5) / 2 / static_cast<double>(bins));
  }
  return rates;
}

// int K(w, v) dv over the part of (lower, upper) that a jump from w can reach: v = s sin(psi).
double KernelMass(double w, double lower, double upper) {
  const double s = std::sqrt(1 - w * w);
  const double kink = Angle(std::clamp(w, lower, upper), s);
  return kJumpKernelPrefactor *
         (w * (kink - Angle(lower, s)) + s * (std::cos(kink) - std::cos(Angle(upper, s))));
}

}  // namespace

EnergyLaw::EnergyLaw(const Discretisation& discretisation, int bins)
    : bins_(static_cast<size_t>(bins)),
      middle_rates_(MiddleRates(bins_)),
      all_(ModesOf(Generator(discretisation))),
      losses_(ModesOf(Generator::OfLosses(discretisation))) {}

EnergyLaw::Modes EnergyLaw::ModesOf(Generator generator) const {
  std::vector<Node> nodes;
  for (size_t bin = 0; bin < bins_; ++bin) {
    const double lower = Edge(bin), upper = Edge(bin + 1);
    const double a = lower + kNode * (upper - lower), b = upper - kNode * (upper - lower);
    nodes.push_back(NodeBetween(generator, bin, a, b));
    nodes.push_back(NodeBetween(generator, bin, b, a));
  }
  return {std::move(generator), std::move(nodes)};
}

EnergyLaw::Node EnergyLaw::NodeBetween(const Generator& generator, size_t bin, double u,
                                       double other_u) const {
  Node node = {bin, JumpRate(u), Eigen::ArrayXd::Zero(generator.size())};
  ForEachGaussNode<kSetUpNodes>(Edge(bin), Edge(bin + 1), [&](double v, double weight) {
    node.gains += weight * (v - other_u) / (u - other_u) * generator.Gains(v).array();
  });
  return node;
}

double EnergyLaw::Edge(size_t bin) const {
  return std::sqrt(static_cast<double>(bin) / static_cast<double>(bins_));
}

EnergyLaw::Start EnergyLaw::From(double epsilon) const {
  // Rounded as the energies in samples, so that an energy on an edge is in the same bin.
  const double start = std::sqrt(2 * epsilon);
  const size_t bin = Histogram::OfBins(0, 0.5, bins_).BinOf(start * start / 2);
  const double u = std::min(start, kFastest);
  return {u, bin, all_.generator.Gains(u), losses_.generator.Gains(u), FirstJumpsFrom(u)};
}

std::vector<double> EnergyLaw::Probabilities(const Start& start, double t) const {
  const double u = start.u;
  std::vector<double> law(bins_);
  law[start.bin] = Decay(JumpRate(u), t).left;
  AddOneJump(u, t, law);
  AddTwoJumps(start, t, law);
  AddModes(all_, start.gains, u, t, law);
  AddModes(losses_, -start.gains_of_losses, u, t, law);
  double sum = 0;
  for (double& probability : law) sum += probability = std::max(probability, 0.0);
  for (double& probability : law) probability /= sum;
  return law;
}

// With u' = s sin(phi), K du' = max(u, u') dphi times a constant; its kink is at u' = u.
void EnergyLaw::AddOneJump(double u, double t, std::vector<double>& law) const {
  const double s = std::sqrt(1 - u * u);
  const Decay start(JumpRate(u), t);
  for (size_t bin = 0; bin < bins_ && Edge(bin) < s; ++bin) {
    const double lower = Edge(bin), upper = Edge(bin + 1), kink = std::clamp(u, lower, upper);
    const auto add = [&](double phi, double weight) {
      const double v = s * std::sin(phi);
      law[bin] += weight * kJumpKernelPrefactor * std::max(u, v) *
                  TwoStages(start, Decay(JumpRate(v), t), t);
    };
    ForEachGaussNode<6>(Angle(lower, s), Angle(kink, s), add);
    ForEachGaussNode<6>(Angle(kink, s), Angle(upper, s), add);
  }
}

// The places w = s sin(phi) after the first jump, as above. The mass that jumps from w into a bin
// has a square-root singularity at the w from which the bin's upper edge is just reached.
std::vector<EnergyLaw::FirstJump> EnergyLaw::FirstJumpsFrom(double u) const {
  const double s = std::sqrt(1 - u * u);
  std::vector<FirstJump> jumps;
  const auto add = [&](double phi, double weight) {
    const double w = s * std::sin(phi);
    jumps.push_back({JumpRate(w), weight * kJumpKernelPrefactor * std::max(u, w), {}});
    for (size_t bin = 0; bin < bins_ && Edge(bin) < std::sqrt(1 - w * w); ++bin) {
      jumps.back().into_bins.push_back(KernelMass(w, Edge(bin), Edge(bin + 1)));
    }
  };
  std::vector<double> ends = {0, std::min(u, s), s};
  for (size_t bin = 1; bin < bins_; ++bin) ends.push_back(std::sqrt(1 - Edge(bin) * Edge(bin)));
  std::sort(ends.begin(), ends.end());
  for (size_t i = 1; i < ends.size() && ends[i] <= s; ++i) {
    ForEachGaussNodeWithRoot<4>(std::asin(ends[i - 1] / s), std::asin(ends[i] / s), add);
  }
  return jumps;
}

void EnergyLaw::AddTwoJumps(const Start& from, double t, std::vector<double>& law) const {
  const Decay start(JumpRate(from.u), t);
  std::vector<Decay> ends;
  std::vector<double> to_ends;
  for (const double rate : middle_rates_) {
    to_ends.push_back(TwoStages(start, ends.emplace_back(rate, t), t));
  }
  for (const FirstJump& jump : from.first_jumps) {
    const Decay between(jump.rate, t);
    const double to_between = TwoStages(start, between, t);
    for (size_t bin = 0; bin < jump.into_bins.size(); ++bin) {
      law[bin] += jump.weight * jump.into_bins[bin] *
                  ThreeStages(start, between, ends[bin], to_between, to_ends[bin], t);
    }
  }
}

void EnergyLaw::AddModes(const Modes& modes, const Eigen::ArrayXd& gains, double u, double t,
                         std::vector<double>& law) const {
  const Decay start(JumpRate(u), t);
  std::vector<Decay> rates;
  std::vector<double> to_rates;
  for (const double rate : modes.generator.rates()) {
    to_rates.push_back(TwoStages(start, rates.emplace_back(rate, t), t));
  }
  for (const Node& node : modes.nodes) {
    const Decay end(node.rate, t);
    const double to_end = TwoStages(start, end, t);
    double sum = 0;
    for (size_t k = 0; k < rates.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      sum += gains[i] * node.gains[i] * ThreeStages(start, rates[k], end, to_rates[k], to_end, t);
    }
    law[node.bin] += sum;
  }
}

}  // namespace ballpiston
