#include "tools/conductivity/galerkin_form.h"

#include <absl/container/flat_hash_set.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/conductivity/contact_matrix.h"

namespace ballpiston {
namespace {

using Environments = absl::flat_hash_set<Monomial>;

// `monomial` as seen from the contact if its factor `f` is at the contact's site `end`; without its
// factors on the contact.
Monomial EnvironmentOf(const Monomial& monomial, const Factor& f, const SiteContact& contact,
                       Site end) {
  Monomial rest;
  for (Factor other : monomial) {
    other.site.x = static_cast<int16_t>(other.site.x - f.site.x + end.x);
    other.site.y = static_cast<int16_t>(other.site.y - f.site.y + end.y);
    if (other.site != contact.a && other.site != contact.b) rest.push_back(other);
  }
  return rest;
}

// Whether a translation maps one site to the other. If there is none, the environment contains no
// function of the basis, and would only cost time.
bool AreOfOneKind(Site a, Site b, int period) {
  return (a.x - b.x) % period == 0 && (a.y - b.y) % period == 0;
}

// All environments, by the degree that remains for the contact.
std::vector<std::vector<Monomial>> AllEnvironments(const SiteLattice& lattice,
                                                   const SiteContact& contact,
                                                   const ClusterBasis& basis) {
  Environments found;
  for (const Monomial& representative : basis.monomials()) {
    for (const Monomial& monomial : basis.Reflections(representative)) {
      for (const Factor& f : monomial) {
        for (const Site end : {contact.a, contact.b}) {
          if (!AreOfOneKind(f.site, end, lattice.period)) continue;
          found.insert(EnvironmentOf(monomial, f, contact, end));
        }
      }
    }
  }
  std::vector<std::vector<Monomial>> sorted(static_cast<size_t>(basis.limits().degree) + 1);
  for (const Monomial& rest : found) {
    sorted[static_cast<size_t>(basis.limits().degree - TotalDegree(rest))].push_back(rest);
  }
  for (std::vector<Monomial>& same : sorted) std::sort(same.begin(), same.end());
  return sorted;
}

// With p_i on the contact's site a and p_j on b.
Monomial WithPair(const Monomial& rest, const SiteContact& contact, int i, int j) {
  Monomial monomial = rest;
  if (i > 0) monomial.push_back({contact.a, static_cast<int16_t>(i)});
  if (j > 0) monomial.push_back({contact.b, static_cast<int16_t>(j)});
  return monomial;
}

// Row 0 is that of p_1(e_a), because the constant has no row.
Eigen::MatrixXd WithoutConstant(const Eigen::MatrixXd& contact) {
  return contact.bottomRightCorner(contact.rows() - 1, contact.cols() - 1);
}
int RowOf(int i, int j) { return ContactRow(i, j) - 1; }
Eigen::Index RowsOf(size_t degree) { return ContactRows(static_cast<int>(degree)) - 1; }

Eigen::MatrixXi PlacesOf(const std::vector<Monomial>& environments, size_t degree,
                         const SiteContact& contact, const ClusterBasis& basis) {
  Eigen::MatrixXi places(RowsOf(degree), static_cast<Eigen::Index>(environments.size()));
  for (size_t k = 0; k < environments.size(); ++k) {
    for (int total = 1; total <= static_cast<int>(degree); ++total) {
      for (int j = 0; j <= total; ++j) {
        places(RowOf(total - j, j), static_cast<Eigen::Index>(k)) =
            basis.Find(WithPair(environments[k], contact, total - j, j));
      }
    }
  }
  return places;
}

// The entries of v at the places, and the reverse, which adds.
Eigen::MatrixXd Gather(const Eigen::VectorXd& v, const Eigen::Ref<const Eigen::MatrixXi>& places) {
  return places.unaryExpr([&](int place) {
    return place == 0 ? 0.0 : place > 0 ? v[place - 1] : -v[-place - 1];
  });
}

void Scatter(const Eigen::MatrixXd& values, const Eigen::Ref<const Eigen::MatrixXi>& places,
             Eigen::VectorXd& v) {
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const int place = places.reshaped()[k];
    if (place > 0) v[place - 1] += values.reshaped()[k];
    if (place < 0) v[-place - 1] -= values.reshaped()[k];
  }
}

constexpr Eigen::Index kColumnsAtOnce = 256;

}  // namespace

GalerkinForm::GalerkinForm(const SiteLattice& lattice, const ClusterBasis& basis)
    : contact_(WithoutConstant(ContactMatrix(lattice.dimensions, basis.limits().degree))),
      scales_(Eigen::VectorXd::Zero(basis.size())),
      field_(Eigen::VectorXd::Zero(basis.size())) {
  for (const SiteContact& c : lattice.contacts) {
    const std::vector<std::vector<Monomial>> environments = AllEnvironments(lattice, c, basis);
    for (size_t degree = 1; degree < environments.size(); ++degree) {
      Eigen::MatrixXi places = PlacesOf(environments[degree], degree, c, basis);
      const Eigen::VectorXd diagonal = c.copies * contact_.diagonal().head(places.rows());
      Scatter(diagonal.replicate(1, places.cols()), places.cwiseAbs(), scales_);
      blocks_.push_back({std::move(places), static_cast<double>(c.copies)});
    }
    AddField(c, basis, lattice.dimensions);
  }
}

// X is x_a e_a + x_b e_b at the contact, and e_a + e_b is conserved, so L X = (x_a - x_b) L e_a,
// where e_a = sqrt(d_a/2) p_1 + d_a/2.
void GalerkinForm::AddField(const SiteContact& contact, const ClusterBasis& basis,
                            SiteDimensions dimensions) {
  const double slope = contact.field() * std::sqrt(dimensions.a / 2.0);
  const Eigen::MatrixXi places =
      PlacesOf({Monomial{}}, static_cast<size_t>(basis.limits().degree), contact, basis);
  const Eigen::VectorXd coupling = contact_.col(RowOf(1, 0)).head(places.rows());
  Scatter(contact.copies * slope * coupling, places, field_);
  field_energy_ += contact.copies * slope * slope * contact_(RowOf(1, 0), RowOf(1, 0));
}

Eigen::VectorXd GalerkinForm::Apply(const Eigen::VectorXd& v) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(v.size());
  for (const Blocks& blocks : blocks_) {
    const auto matrix = contact_.topLeftCorner(blocks.places.rows(), blocks.places.rows());
    for (Eigen::Index first = 0; first < blocks.places.cols(); first += kColumnsAtOnce) {
      const Eigen::Index count = std::min(kColumnsAtOnce, blocks.places.cols() - first);
      const auto places = blocks.places.middleCols(first, count);
      Scatter(blocks.copies * matrix * Gather(v, places), places, result);
    }
  }
  return result;
}

}  // namespace ballpiston
