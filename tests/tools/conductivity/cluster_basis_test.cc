#include "tools/conductivity/cluster_basis.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

Factor At(int x, int y, int degree) {
  return {{static_cast<int16_t>(x), static_cast<int16_t>(y)}, static_cast<int16_t>(degree)};
}

ClusterBasis ChainBasis(int length, int degree) {
  const SiteLattice chain = BallPistonChain();
  return {chain, ChainClusters(chain, length), {.degree = degree}};
}

ClusterBasis LatticeBasis() {
  const SiteLattice lattice = BallPistonLattice();
  return {lattice, LatticeClusters(lattice, 1), {.degree = 4}};
}

TEST(ClusterBasis, TranslatesAreOneFunction) {
  const ClusterBasis basis = ChainBasis(3, 5);
  const int found = basis.Find({At(0, 0, 1), At(1, 0, 3)});
  EXPECT_NE(found, 0);
  for (const int shift : {-6, -2, 2, 8}) {
    EXPECT_EQ(basis.Find({At(shift, 0, 1), At(shift + 1, 0, 3)}), found);
  }
  // The same polynomials of a ball and of a piston are different functions.
  EXPECT_NE(std::abs(basis.Find({At(1, 0, 1), At(2, 0, 3)})), std::abs(found));
}

TEST(ClusterBasis, ReflectionsDifferInSignOnly) {
  const ClusterBasis chain = ChainBasis(3, 5);
  EXPECT_EQ(chain.Find({At(0, 0, 2), At(1, 0, 1)}), -chain.Find({At(-1, 0, 1), At(0, 0, 2)}));
  EXPECT_EQ(chain.Find({At(0, 0, 2)}), 0);
  EXPECT_EQ(chain.Find({At(-1, 0, 1), At(1, 0, 1)}), 0);
  EXPECT_NE(chain.Find({At(-1, 0, 1), At(1, 0, 2)}), 0);

  const ClusterBasis lattice = LatticeBasis();
  const int found = lattice.Find({At(0, 0, 1), At(0, 1, 1), At(1, 0, 1)});
  EXPECT_NE(found, 0);
  EXPECT_EQ(lattice.Find({At(0, -1, 1), At(0, 0, 1), At(1, 0, 1)}), found);
  EXPECT_EQ(lattice.Find({At(-1, 0, 1), At(0, 0, 1), At(0, 1, 1)}), -found);
  EXPECT_EQ(lattice.Find({At(0, 0, 1), At(0, 1, 1)}), 0);
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
  const ClusterBasis lattice = LatticeBasis();
  for (const Monomial& monomial : lattice.monomials()) {
    EXPECT_LE(TotalDegree(monomial), 4);
    EXPECT_GT(lattice.Find(monomial), 0);
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
