// Functions of the energies of a few neighbouring sites, summed over all their translates.
//
// A monomial is a product of orthonormal polynomials (gamma_law.h), one for each of its sites, of
// degree 1 or more. Its translates count as the same function. Only combinations that are odd under
// the reflection of x, like the field, and even under the reflection of y contribute. So a function
// of the basis is the sum of a monomial's reflections with these signs. A monomial whose
// reflections cancel gives no function.
//
// Translates are one function, and reflections differ in sign only.
//
// Immutable; safe to share between threads.
#pragma once

#include <absl/container/flat_hash_map.h>
#include <absl/container/inlined_vector.h>

#include <compare>
#include <cstdint>
#include <utility>
#include <vector>

#include "tools/conductivity/site_lattice.h"

namespace ballpiston {

struct Factor {
  Site site;
  int16_t degree = 0;  // 1 or more

  friend auto operator<=>(const Factor&, const Factor&) = default;
  template <typename H>
  friend H AbslHashValue(H state, const Factor& f) {
    return H::combine(std::move(state), f.site.x, f.site.y, f.degree);
  }
};

using Monomial = absl::InlinedVector<Factor, 8>;  // sorted by site

int TotalDegree(const Monomial& monomial);

// The sites that the functions may depend on, up to translation.
using Cluster = std::vector<Site>;

// In a chain: `extent` neighbouring sites. In the lattice three clusters: the sites with |x| + |y|
// up to `extent` from a ball, from a piston that moves along x, and from a piston that moves along
// y.
std::vector<Cluster> Clusters(const SiteLattice& lattice, int extent);

struct BasisLimits {
  int degree;       // total degree
  int sites = 100;  // of a monomial
};

class ClusterBasis {
 public:
  ClusterBasis(const SiteLattice& lattice, const std::vector<Cluster>& clusters,
               const BasisLimits& limits);

  int size() const { return static_cast<int>(monomials_.size()); }
  const BasisLimits& limits() const { return limits_; }
  // One for each function.
  const std::vector<Monomial>& monomials() const { return monomials_; }
  // k + 1 for a monomial with the sign + in function k, -(k + 1) for the sign -, 0 for a monomial
  // in no function.
  int Find(const Monomial& monomial) const;
  // All reflections of a monomial; those at odd places are reflected in x.
  std::vector<Monomial> Reflections(const Monomial& monomial) const;

 private:
  struct Signed {
    Monomial monomial;
    int sign;  // 0 if its reflections cancel
  };
  Monomial Reflected(const Monomial& monomial, int x_sign, int y_sign) const;
  Signed Representative(const Monomial& monomial) const;
  void AddAll(const Cluster& cluster, size_t next, Monomial& monomial);

  bool has_rows_;
  int16_t period_;
  BasisLimits limits_;
  std::vector<Monomial> monomials_;
  absl::flat_hash_map<Monomial, int> index_;
};

}  // namespace ballpiston
