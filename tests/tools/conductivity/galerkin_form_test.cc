#include "tools/conductivity/galerkin_form.h"

#include <Eigen/Eigenvalues>

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// A function on a ring or torus, by its coefficients.
using Function = std::map<std::vector<Factor>, double>;

// Cells of the ring, or of a side of the torus. Their number is large enough that no function of
// the examples overlaps itself.
int Cells(const SiteLattice& lattice) { return lattice.has_rows ? 3 : 6; }
int Rows(const SiteLattice& lattice) { return lattice.has_rows ? Cells(lattice) : 1; }

Site Moved(const SiteLattice& lattice, Site site, int x, int y) {
  const int length = Cells(lattice) * lattice.period;
  return {static_cast<int16_t>((site.x + x + length) % length),
          static_cast<int16_t>((site.y + y + length) % length)};
}

// The sum over all reflections, with the signs of the field, and all translations.
Function OnTheRing(const SiteLattice& lattice, const Monomial& monomial) {
  Function sum;
  for (const int x_sign : {1, -1}) {
    for (const int y_sign : {1, -1}) {
      if (y_sign < 0 && !lattice.has_rows) continue;
      for (int x = 0; x < Cells(lattice); ++x) {
        for (int y = 0; y < Rows(lattice); ++y) {
          std::vector<Factor> moved;
          for (Factor f : monomial) {
            f.site = {static_cast<int16_t>(x_sign * f.site.x),
                      static_cast<int16_t>(y_sign * f.site.y)};
            f.site = Moved(lattice, f.site, x * lattice.period, y * lattice.period);
            moved.push_back(f);
          }
          std::sort(moved.begin(), moved.end());
          sum[moved] += x_sign;
        }
      }
    }
  }
  return sum;
}

// The basis has 1 and -1 as coefficients. Reflections that agree are counted several times above.
Function Normalised(Function f) {
  double largest = 0;
  for (const auto& row : f) largest = std::max(largest, std::abs(row.second));
  for (auto& row : f) row.second /= largest;
  return f;
}

struct Bond {
  Site a;
  Site b;
  int field;  // x of a minus x of b
};

// All contacts: with the sites beside each ball, or to the right of each equal site.
std::vector<Bond> Bonds(const SiteLattice& lattice) {
  std::vector<Bond> bonds;
  const int p = lattice.period;
  for (int x = 0; x < Cells(lattice); ++x) {
    for (int y = 0; y < Rows(lattice); ++y) {
      const Site a = Moved(lattice, {0, 0}, x * p, y * p);
      bonds.push_back({a, Moved(lattice, a, 1, 0), -1});
      if (p == 2) bonds.push_back({a, Moved(lattice, a, -1, 0), 1});
      if (!lattice.has_rows) continue;
      bonds.push_back({a, Moved(lattice, a, 0, 1), 0});
      bonds.push_back({a, Moved(lattice, a, 0, -1), 0});
    }
  }
  return bonds;
}

// A monomial as seen from a contact.
struct Seen {
  int i = 0;  // degree at a
  int j = 0;  // at b
  std::vector<Factor> rest;
};

Seen From(const Bond& bond, const std::vector<Factor>& monomial) {
  Seen seen;
  for (const Factor& f : monomial) {
    if (f.site == bond.a) {
      seen.i = f.degree;
    } else if (f.site == bond.b) {
      seen.j = f.degree;
    } else {
      seen.rest.push_back(f);
    }
  }
  return seen;
}

// <f, -L_c g> by the definition of a contact, which changes the factors of its two sites alone.
double BondForm(const ContactMatrix& contact, const Bond& bond, const Function& f,
                const Function& g) {
  double sum = 0;
  for (const auto& [monomial_f, coefficient_f] : f) {
    const Seen left = From(bond, monomial_f);
    if (left.i + left.j == 0) continue;
    for (const auto& [monomial_g, coefficient_g] : g) {
      const Seen right = From(bond, monomial_g);
      if (left.rest != right.rest) continue;
      sum += coefficient_f * coefficient_g *
             contact.elements()(ContactMatrix::Row(left.i, left.j),
                                ContactMatrix::Row(right.i, right.j));
    }
  }
  return sum;
}

// <f, -L g> of one cell.
double Form(const SiteLattice& lattice, const ContactMatrix& contact, const Function& f,
            const Function& g) {
  double sum = 0;
  for (const Bond& bond : Bonds(lattice)) sum += BondForm(contact, bond, f, g);
  return sum / (Cells(lattice) * Rows(lattice));
}

// sum(x e) at a contact, minus a function of e_a + e_b.
Function FieldAt(const SiteLattice& lattice, const Bond& bond) {
  return {{{Factor{bond.a, 1}}, bond.field * std::sqrt(lattice.dimensions.a / 2.0)}};
}

// <f, -L X> of one cell.
double FieldForm(const SiteLattice& lattice, const ContactMatrix& contact, const Function& f) {
  double sum = 0;
  for (const Bond& bond : Bonds(lattice)) {
    sum += BondForm(contact, bond, f, FieldAt(lattice, bond));
  }
  return sum / (Cells(lattice) * Rows(lattice));
}

struct Example {
  SiteLattice lattice;
  int degree;
};

// Small enough for the definition.
std::vector<Example> Examples() {
  return {{BallPistonChain(), 4}, {EqualSitesChain(2), 5}, {BallPistonLattice(), 3}};
}

ClusterBasis BasisOf(const Example& example) {
  const SiteLattice& lattice = example.lattice;
  return {lattice,
          lattice.has_rows ? LatticeClusters(lattice, 1) : ChainClusters(lattice, 3),
          {.degree = example.degree}};
}

TEST(GalerkinForm, AgreesWithTheDefinitionOnARing) {
  for (const Example& example : Examples()) {
    const SiteLattice& lattice = example.lattice;
    const ContactMatrix contact(lattice.dimensions, example.degree);
    const ClusterBasis basis = BasisOf(example);
    ASSERT_GT(basis.size(), 4);
    const GalerkinForm form(lattice, basis, contact);
    std::vector<Function> functions;
    for (const Monomial& monomial : basis.monomials()) {
      functions.push_back(Normalised(OnTheRing(lattice, monomial)));
    }
    for (int k = 0; k < basis.size(); ++k) {
      const Function& f = functions[static_cast<size_t>(k)];
      const Eigen::VectorXd column = form.Apply(Eigen::VectorXd::Unit(basis.size(), k));
      EXPECT_NEAR(form.field()[k], FieldForm(lattice, contact, f), 1e-12) << k;
      for (int l = 0; l < basis.size(); ++l) {
        EXPECT_NEAR(column[l], Form(lattice, contact, functions[static_cast<size_t>(l)], f), 1e-12)
            << k << " " << l;
      }
    }
  }
}

TEST(GalerkinForm, IsSymmetricAndPositive) {
  for (const Example& example : Examples()) {
    const ClusterBasis basis = BasisOf(example);
    const GalerkinForm form(example.lattice, basis,
                            ContactMatrix(example.lattice.dimensions, example.degree));
    Eigen::MatrixXd matrix(basis.size(), basis.size());
    for (int k = 0; k < basis.size(); ++k) {
      matrix.col(k) = form.Apply(Eigen::VectorXd::Unit(basis.size(), k));
    }
    EXPECT_LE((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues()[0], 1e-3);
    EXPECT_GT(form.scales().minCoeff(), 0);
  }
}

}  // namespace
}  // namespace ballpiston
