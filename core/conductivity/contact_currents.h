// Mean effects of the exchanges of one contact, at given energies of its ball and piston: the
// energy that exchanges carry, and the change of a test function.
//
// The ball's angle is uniform and both signs of the piston's velocity are equally likely. So with
// the speeds s = sqrt(2 e_b) and w = sqrt(2 e_p), and a change D that depends on the exchange only
// through v_a^2,
//
//   < (v_a - v_b)+ D > = (w/2) <D> + (1/pi) integral over v_a > w of (v_a - w) D
//
// over the angles from 0 to acos(w/s); the last term is 0 if the piston is faster. This term has a
// singularity of the power 3/2 at s = w. So the table has two parts, one for each side of s = w.
// Its variables are the root of the total energy and sqrt(|e_b - e_p|/(e_b + e_p)), in which both
// parts are smooth. Between the nodes cubic polynomials interpolate.
//
// Units: masses and temperature 1; rates are those at a contact's density of 1. Domain: energies of
// at least 0, not both 0. Error of the table: kContactCurrentsError. Properties, each with the test
// that bears its name:
//   1. AgreeWithTheirDefinition.  2. TableErrorIsWithinItsBound.  3. TableTakesEveryEnergy.
//
// The table's lookups run in vector lanes: their bits are the same on every target with fused
// multiply-add. Immutable; safe to share between threads.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/conductivity/test_function.h"

namespace ballpiston {

// Root mean square error in equilibrium, divided by the root mean square of the value.
inline constexpr double kContactCurrentsError = 3e-4;

// Means per unit of time.
struct ContactCurrents {
  using Values = TestFunction::Values;

  double energy = 0;               // the piston's gain of energy
  double products = 0;             // sum_r of (change of u_r) (change of w_r)
  Values ball = Values::Zero();    // the change of u_r
  Values piston = Values::Zero();  // the change of w_r
};

// By quadrature: to 1e-12 for energies up to 10, to 2e-8 up to 36.
ContactCurrents ContactCurrentsOf(const TestFunction& f, double ball_energy, double piston_energy);

class ContactCurrentsTable {
 public:
  // The numbers that a node stores. The functions use six of them; a vector of AVX-512 has eight.
  static constexpr size_t kValues = 8;

  explicit ContactCurrentsTable(const TestFunction& f);

  // Each table is computed once in a process, in about 10 ms.
  static const ContactCurrentsTable& OfChain();
  static const ContactCurrentsTable& OfLattice();

  const TestFunction& test_function() const { return f_; }
  ContactCurrents At(double ball_energy, double piston_energy) const;

 private:
  using Node = std::array<double, kValues>;
  size_t NodeAt(bool is_piston_faster, size_t root, size_t place) const;

  TestFunction f_;
  std::vector<Node> nodes_;
};

}  // namespace ballpiston
