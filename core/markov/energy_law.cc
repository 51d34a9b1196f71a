#include "core/markov/energy_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/markov/gauss_nodes.h"

namespace ballpiston {
namespace {

// Of the two nodes of a bin, from its ends; as a share of its width. Gauss's.
constexpr double kNode = 0.21132486540518713;
constexpr int kSetUpNodes = 16;

// From u = 1 all jumps go to u' = 0; this u avoids the division by 0.
constexpr double kFastest = 1 - 1e-12;

// int_0^t exp(-a s - b (t - s)) ds
double TwoStages(double a, double b, double t) {
  const double x = (a - b) * t;
  return std::exp(-a * t) * (x == 0 ? t : t * std::expm1(x) / x);
}

// The same over the durations of three stages.
double ThreeStages(double a, double b, double c, double t) {
  constexpr double kClose = 1e-3;  // the series leaves out (x t)^2/24 of itself
  const double least = std::min({a, b, c}), most = std::max({a, b, c});
  const double middle = a + b + c - least - most;
  if ((most - least) * t < kClose) return t * t / 2 * std::exp(-(a + b + c) / 3 * t);
  return (TwoStages(least, middle, t) - TwoStages(middle, most, t)) / (most - least);
}

}  // namespace

EnergyLaw::EnergyLaw(const Discretisation& discretisation, int bins)
    : generator_(discretisation), bins_(static_cast<size_t>(bins)) {
  for (size_t bin = 0; bin < bins_; ++bin) {
    const double lower = Edge(bin), upper = Edge(bin + 1);
    const double a = lower + kNode * (upper - lower), b = upper - kNode * (upper - lower);
    nodes_.push_back(NodeBetween(bin, a, b));
    nodes_.push_back(NodeBetween(bin, b, a));
  }
}

EnergyLaw::Node EnergyLaw::NodeBetween(size_t bin, double u, double other_u) const {
  Node node = {bin, JumpRate(u), Eigen::ArrayXd::Zero(generator_.size())};
  ForEachGaussNode<kSetUpNodes>(Edge(bin), Edge(bin + 1), [&](double v, double weight) {
    node.gains += weight * (v - other_u) / (u - other_u) * generator_.Gains(v).array();
  });
  return node;
}

double EnergyLaw::Edge(size_t bin) const {
  return std::sqrt(static_cast<double>(bin) / static_cast<double>(bins_));
}

std::vector<double> EnergyLaw::Probabilities(double epsilon, double t) const {
  const double u = std::min(std::sqrt(2 * epsilon), kFastest);
  std::vector<double> law(bins_);
  const auto start = static_cast<size_t>(2 * epsilon * static_cast<double>(bins_));
  law[std::min(start, bins_ - 1)] = std::exp(-JumpRate(u) * t);
  AddOneJump(u, t, law);
  AddMoreJumps(u, t, law);
  return law;
}

// With u' = s sin(phi), K du' = max(u, u') dphi but for its prefactor; its kink is at u' = u.
void EnergyLaw::AddOneJump(double u, double t, std::vector<double>& law) const {
  const double s = std::sqrt(1 - u * u), rate = JumpRate(u);
  const auto angle = [s](double v) { return v < s ? std::asin(v / s) : std::numbers::pi / 2; };
  for (size_t bin = 0; bin < bins_ && Edge(bin) < s; ++bin) {
    const double lower = Edge(bin), upper = Edge(bin + 1), kink = std::clamp(u, lower, upper);
    const auto add = [&](double phi, double weight) {
      const double v = s * std::sin(phi);
      law[bin] += weight * kJumpKernelPrefactor * std::max(u, v) * TwoStages(rate, JumpRate(v), t);
    };
    ForEachGaussNode<6>(angle(lower), angle(kink), add);
    ForEachGaussNode<6>(angle(kink), angle(upper), add);
  }
}

void EnergyLaw::AddMoreJumps(double u, double t, std::vector<double>& law) const {
  const double rate = JumpRate(u);
  const Eigen::ArrayXd gains = generator_.Gains(u);
  for (const Node& node : nodes_) {
    const Eigen::ArrayXd stages =
        generator_.rates().unaryExpr([&](double k) { return ThreeStages(rate, k, node.rate, t); });
    law[node.bin] += (gains * node.gains * stages).sum();
  }
}

}  // namespace ballpiston
