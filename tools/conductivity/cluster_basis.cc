#include "tools/conductivity/cluster_basis.h"

#include <algorithm>
#include <cstdlib>

namespace ballpiston {
namespace {

// The multiple of the period at or below x.
int16_t CellStart(int16_t x, int16_t period) {
  const int remainder = x % period;
  return static_cast<int16_t>(x - (remainder < 0 ? remainder + period : remainder));
}

// To the cell at the origin: the least coordinates decide.
void TranslateToOrigin(int16_t period, Monomial& monomial) {
  Site least = monomial.front().site;
  for (const Factor& f : monomial) {
    least = {std::min(least.x, f.site.x), std::min(least.y, f.site.y)};
  }
  const Site origin = {CellStart(least.x, period), CellStart(least.y, period)};
  for (Factor& f : monomial) {
    f.site.x = static_cast<int16_t>(f.site.x - origin.x);
    f.site.y = static_cast<int16_t>(f.site.y - origin.y);
  }
}

int Distance(Site a, Site b) { return std::abs(a.x - b.x) + std::abs(a.y - b.y); }

Cluster Around(const SiteLattice& lattice, Site centre, int radius) {
  Cluster cluster;
  for (int x = centre.x - radius; x <= centre.x + radius; ++x) {
    for (int y = centre.y - radius; y <= centre.y + radius; ++y) {
      const Site site = {static_cast<int16_t>(x), static_cast<int16_t>(y)};
      if (lattice.HasSite(site) && Distance(site, centre) <= radius) cluster.push_back(site);
    }
  }
  return cluster;
}

}  // namespace

int TotalDegree(const Monomial& monomial) {
  int sum = 0;
  for (const Factor& f : monomial) sum += f.degree;
  return sum;
}

std::vector<Cluster> Clusters(const SiteLattice& lattice, int extent) {
  if (lattice.has_rows) {
    return {Around(lattice, {0, 0}, extent), Around(lattice, {1, 0}, extent),
            Around(lattice, {0, 1}, extent)};
  }
  std::vector<Cluster> clusters(static_cast<size_t>(lattice.period));
  for (int start = 0; start < lattice.period; ++start) {
    for (int k = 0; k < extent; ++k) {
      clusters[static_cast<size_t>(start)].push_back({static_cast<int16_t>(start + k), 0});
    }
  }
  return clusters;
}

ClusterBasis::ClusterBasis(const SiteLattice& lattice, const std::vector<Cluster>& clusters,
                           const BasisLimits& limits)
    : has_rows_(lattice.has_rows), period_(static_cast<int16_t>(lattice.period)), limits_(limits) {
  for (Cluster cluster : clusters) {
    std::sort(cluster.begin(), cluster.end());
    Monomial monomial;
    AddAll(cluster, 0, monomial);
  }
}

// Every continuation of the monomial by sites from `next` on.
void ClusterBasis::AddAll(const Cluster& cluster, size_t next, Monomial& monomial) {
  if (!monomial.empty()) {
    Signed found = Representative(monomial);
    if (found.sign != 0 && index_.try_emplace(found.monomial, size()).second) {
      monomials_.push_back(std::move(found.monomial));
    }
  }
  if (static_cast<int>(monomial.size()) == limits_.sites) return;
  const int left = limits_.degree - TotalDegree(monomial);
  for (size_t k = next; k < cluster.size(); ++k) {
    for (int degree = 1; degree <= left; ++degree) {
      monomial.push_back({cluster[k], static_cast<int16_t>(degree)});
      AddAll(cluster, k + 1, monomial);
      monomial.pop_back();
    }
  }
}

int ClusterBasis::Find(const Monomial& monomial) const {
  if (monomial.empty()) return 0;
  const Signed found = Representative(monomial);
  const auto at = index_.find(found.monomial);
  return at == index_.end() ? 0 : found.sign * (at->second + 1);
}

Monomial ClusterBasis::Reflected(const Monomial& monomial, int x_sign, int y_sign) const {
  Monomial reflected = monomial;
  for (Factor& f : reflected) {
    f.site = {static_cast<int16_t>(x_sign * f.site.x), static_cast<int16_t>(y_sign * f.site.y)};
  }
  TranslateToOrigin(period_, reflected);
  std::sort(reflected.begin(), reflected.end());
  return reflected;
}

std::vector<Monomial> ClusterBasis::Reflections(const Monomial& monomial) const {
  std::vector<Monomial> all;
  for (const int y_sign : {1, -1}) {
    if (y_sign < 0 && !has_rows_) break;
    for (const int x_sign : {1, -1}) all.push_back(Reflected(monomial, x_sign, y_sign));
  }
  return all;
}

// The least reflection. Those at odd places are reflected in x.
ClusterBasis::Signed ClusterBasis::Representative(const Monomial& monomial) const {
  const std::vector<Monomial> all = Reflections(monomial);
  const Monomial& least = *std::min_element(all.begin(), all.end());
  int sum = 0;
  for (size_t k = 0; k < all.size(); ++k) {
    if (all[k] == least) sum += k % 2 == 0 ? 1 : -1;
  }
  return {least, (sum > 0) - (sum < 0)};
}

}  // namespace ballpiston
