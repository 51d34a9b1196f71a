#include "tools/conductivity/cluster_basis.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

ClusterBasis ChainBasis(int length, int degree) {
  const SiteLattice chain = BallPistonChain();
  return {chain, ChainClusters(chain, length), {.degree = degree}};
}

// There are n(k, d) functions of degree d or less of k neighbouring sites. n(k, d) - n(k - 1, d) of
// them begin at the first site. The basis has one for each pair of a function and its different
// reflection, both for clusters that begin with a ball and for those that begin with a piston.
TEST(ClusterBasis, HasEveryFunctionOfTheCluster) {
  // Two sites of degrees (i, j): if the sites are of different kinds, all (i, j) count; if they are
  // of the same kind, only i < j.
  EXPECT_EQ(ChainBasis(2, 4).size(), 6);
  EXPECT_EQ(ChainBasis(1, 9).size(), 0);
  // Length 3 adds (i, m, j) with i < j around a ball or a piston: of degree 4 or less (1,0,2),
  // (1,0,3), (1,1,2).
  EXPECT_EQ(ChainBasis(3, 4).size(), 6 + 2 * 3);
  const SiteLattice lattice = BallPistonLattice();
  const ClusterBasis basis(lattice, LatticeClusters(lattice, 1), {.degree = 4});
  for (const Monomial& monomial : basis.monomials()) {
    EXPECT_LE(TotalDegree(monomial), 4);
    EXPECT_GT(basis.Find(monomial), 0);
  }
}

TEST(ClusterBasis, LimitsTheNumberOfSites) {
  const SiteLattice chain = BallPistonChain();
  const ClusterBasis basis(chain, ChainClusters(chain, 5), {.degree = 5, .sites = 2});
  for (const Monomial& monomial : basis.monomials()) EXPECT_LE(monomial.size(), 2);
  EXPECT_GT(basis.size(), ChainBasis(2, 5).size());
}

}  // namespace
}  // namespace ballpiston
