#include "core/statistics/group_scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/statistics/moments.h"

namespace ballpiston {
namespace {

using ByGroup = std::array<double, kGroups>;

// The sample variance between groups of (x - s)^2/(s (1 - s)), s = 1/G, where x is 1 in one group,
// which has a sample or an orbit, and 0 in the others.
constexpr double kOwn = kGroups * (kGroups - 2.0) * (kGroups - 2) / ((kGroups - 1) * (kGroups - 1));

// Q_gh, and its mean and scatter for independent samples.
class GroupProducts {
 public:
  GroupProducts(std::span<const Histogram> groups, size_t rows) : groups_(groups) {
    for (size_t g = 0; g < kGroups; ++g) shares_[g] = static_cast<double>(groups[g].Total());
    double all = 0;
    for (const double total : shares_) all += total;
    for (double& share : shares_) share /= all;
    samples_ = all;
    const size_t cells = groups[0].counts.size(), of_a_row = cells / rows;
    for (size_t first = 0; first < cells; first += of_a_row) AddRow(first, of_a_row);
  }

  double freedom() const { return freedom_; }
  // The same for the scatter of Q_gh. Q is a form of pairs of samples, 1/n_c - 1/n_r for two of one
  // cell and -1/n_r for two of one row. Its squares sum to freedom(), but a sample with itself
  // hardly scatters, with 2/G of the scatter of others.
  double freedom_of_pairs() const { return freedom_ - (1 - 2.0 / kGroups) * of_themselves_; }
  // The part of the sample variance between groups of Q_gg/(s (1 - s)), s a group's share, that
  // comes from each independent sample with itself.
  double ScatterOfThemselves() const {
    return kOwn * std::max(of_themselves_ - freedom_ * freedom_ / samples_, 0.0);
  }
  double Of(size_t g, size_t h) const { return products_[g][h]; }
  double Share(size_t g) const { return shares_[g]; }

 private:
  void AddRow(size_t first, size_t cells) {
    ByGroup of_row = {};
    double samples = 0;
    for (size_t cell = first; cell < first + cells; ++cell) samples += CountOf(cell);
    for (size_t cell = first; cell < first + cells; ++cell) {
      if (const double count = CountOf(cell); count > 0) {
        of_themselves_ += count * std::pow(1 / count - 1 / samples, 2);
      }
      ByGroup counts;
      for (size_t g = 0; g < kGroups; ++g) {
        counts[g] = static_cast<double>(groups_[g].counts[cell]);
        of_row[g] += counts[g];
      }
      Add(counts, 1);
    }
    Add(of_row, -1);
  }

  double CountOf(size_t cell) const {
    double count = 0;
    for (const Histogram& group : groups_) count += static_cast<double>(group.counts[cell]);
    return count;
  }

  void Add(const ByGroup& counts, double sign) {
    double all = 0;
    for (const double count : counts) all += count;
    if (all == 0) return;
    ByGroup deviations;
    for (size_t g = 0; g < kGroups; ++g) deviations[g] = counts[g] - shares_[g] * all;
    for (size_t g = 0; g < kGroups; ++g) {
      for (size_t h = 0; h <= g; ++h) {
        products_[g][h] += sign * deviations[g] * deviations[h] / all;
      }
    }
    freedom_ += sign;
  }

  std::span<const Histogram> groups_;
  ByGroup shares_ = {};
  double samples_ = 0;
  double freedom_ = 0;        // cells less rows, without empty ones
  double of_themselves_ = 0;  // sum of squares of the form for each sample with itself
  std::array<ByGroup, kGroups> products_ = {};
};

}  // namespace

bool HaveSamples(std::span<const Histogram> groups) {
  return std::ranges::all_of(groups, [](const Histogram& group) { return group.Total() > 0; });
}

// The deviations of all groups sum to 0. So the mean of Q_gh, g other than h, is fixed by the Q_gg,
// and G of its G (G - 1)/2 degrees of freedom are lost.
GroupScatter ScatterOfGroups(std::span<const Histogram> groups, size_t rows) {
  const GroupProducts products(groups, rows);
  if (products.freedom_of_pairs() <= 0) return {};
  constexpr double kPairs = kGroups * (kGroups - 1) / 2.0;
  double on_diagonal = 0, pairs_of_shares = 0;
  Moments own;  // Q_gg/(s (1 - s))
  for (size_t g = 0; g < kGroups; ++g) {
    const double share = products.Share(g) * (1 - products.Share(g));
    on_diagonal += products.Of(g, g);
    pairs_of_shares += share / 2;
    own.Add(products.Of(g, g) / share);
  }
  double scatter = 0;
  for (size_t g = 0; g < kGroups; ++g) {
    for (size_t h = 0; h < g; ++h) {
      scatter += std::pow(products.Of(g, h) + on_diagonal / (2 * kPairs), 2);
    }
  }
  scatter *= kPairs / kFreedomOfPairs;
  const double of_pairs = scatter / (pairs_of_shares * products.freedom_of_pairs());
  const double of_a_group =
      (*own.Variance() - products.ScatterOfThemselves()) / (2 * products.freedom_of_pairs());
  const double of_orbits = std::max(of_a_group - of_pairs, 0.0) / kOwn;
  return {on_diagonal / (2 * pairs_of_shares * products.freedom()), of_pairs, of_orbits};
}

double VarianceBetweenGroups(std::span<const Histogram> groups, std::span<const double> weights) {
  double sum = 0;
  for (const Histogram& group : groups) {
    double of_group = 0;
    for (size_t cell = 0; cell < weights.size(); ++cell) {
      of_group += weights[cell] * static_cast<double>(group.counts[cell]);
    }
    sum += of_group * of_group;
  }
  return sum * kGroups / kFreedomOfGroups;
}

std::vector<uint64_t> CountsOf(std::span<const Histogram> groups) {
  Histogram all = groups[0];
  for (const Histogram& group : groups.subspan(1)) all.Merge(group);
  return all.counts;
}

double FreedomOfSum(double a, double freedom_of_a, double b, double freedom_of_b) {
  return std::pow(a + b, 2) / (a * a / freedom_of_a + b * b / freedom_of_b);
}

}  // namespace ballpiston
