// The matrix of the jump process's generator between the functions of a cluster basis, and the
// field's coupling to these functions.
//
// With the field X = sum(x e), the functions f_k of the basis, each summed over all translates, and
// sums over the contacts of one cell,
//
//   A_kl = sum <f_k, -L_c f_l>,   b_k = sum <f_k, -L_c X>,   E = sum <X, -L_c X>.
//
// A contact changes two sites only. So the basis is divided into blocks. A block is a contact with
// all monomials that agree on the other sites; their common part is the environment. The block's
// part of A is the leading part of the ContactMatrix, up to the total degree less the environment's
// degree. Blocks of the same degree are multiplied together.
//
// Units: those of contact_matrix.h; lengths are distances of neighbouring sites. The tests
// of conductivity.h compare its results with published and with sampled values.
//
// Immutable; safe to share between threads.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/conductivity/cluster_basis.h"
#include "tools/conductivity/site_lattice.h"

namespace ballpiston {

class GalerkinForm {
 public:
  GalerkinForm(const SiteLattice& lattice, const ClusterBasis& basis);

  // A v.
  Eigen::VectorXd Apply(const Eigen::VectorXd& v) const;
  // The diagonal of A without the couplings of a function to its own reflections; positive.
  const Eigen::VectorXd& scales() const { return scales_; }
  const Eigen::VectorXd& field() const { return field_; }  // b
  double field_energy() const { return field_energy_; }    // E

 private:
  // Places in the basis by ClusterBasis::Find, a column for each environment, a row for each
  // product of the contact's two polynomials, without the constant.
  struct Blocks {
    Eigen::MatrixXi places;
    double copies;
  };
  void AddField(const SiteContact& contact, const ClusterBasis& basis, SiteDimensions dimensions);

  Eigen::MatrixXd contact_;  // without the constant's row and column
  std::vector<Blocks> blocks_;
  Eigen::VectorXd scales_;
  Eigen::VectorXd field_;
  double field_energy_ = 0;
};

}  // namespace ballpiston
