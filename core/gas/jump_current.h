// The conductivity of the jump process by Green and Kubo's formula, with little scatter.
//
// Between exchanges the expected current at the present energies is known exactly: J = sum over the
// contacts along x of (1/2) j(e_b, e_p). The process is reversible, so
//
//   kappa T^2 = kappa_0 T^2 - (integral over t > 0 of <J(0) J(t)>)/cells
//
// and only a correction of 0.2 % of the conductivity has scatter. J changes only at exchanges, so
// its integral over each step is exact. The part of J that is a sum of functions of one energy adds
// up to 0 round a ring.
//
// The same formula holds with the current J' = L(X + f) of a test function f, and a bound in place
// of kappa_0 (conductivity/test_function.h); this gives `conductivity`. Here f = sum over balls and
// r of u_r(ball) A_r(ball). A_r of a ball is w_r of the piston on its right minus w_r of the piston
// on its left. B_r of a piston is u_r of the ball on its left minus u_r of the ball on its right.
// Then
//
//   2 J' = sum over contacts along x of +-(j + sum_r <(change of u_r) (change of w_r)>)
//        + sum over balls, r of A_r (L u_r) + sum over pistons along x, r of B_r (L w_r).
//
// L u_r of a ball is the sum over its contacts. An exchange changes the terms of two balls and two
// pistons. A gas of one column has no current.
//
// Property, with the test that bears its name: 1. ConductivityOfTheJumpProcessMatchesTheSpectrum.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/conductivity/contact_currents.h"
#include "core/gas/current_meter.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"

namespace ballpiston {

class JumpCurrent : public CurrentMeter {
 public:
  // `exchange_rate` is that of the gas at temperature 1. The gas is periodic.
  JumpCurrent(const GasGeometry& geometry, double exchange_rate, const GasState& start,
              double duration);

  void Exchange(const GasEvent& exchange, double carried) override;
  void End(double time) override { AddUntil(time); }
  GreenKubo Result() const override;

 private:
  using Values = TestFunction::Values;

  struct Body {
    double energy = 0;
    Values values = Values::Zero();  // u_r of a ball, w_r of a piston
    Values change = Values::Zero();  // L u_r, L w_r
    double term = 0;                 // of 2 J'
  };
  struct Contact {
    size_t ball = 0;
    size_t piston = 0;
    double sign = 0;  // of x from ball to piston
    ContactCurrents now = {};
  };

  void Connect(const GasGeometry& geometry);
  void FindContact(Contact& contact);
  void FindBallTerm(size_t ball);
  void FindPistonTerm(size_t piston);
  void SetTerm(double term, Body& body);
  void AddUntil(double time);

  const ContactCurrentsTable& table_;
  size_t directions_;
  double bound_;
  double density_;
  std::vector<Body> balls_;
  std::vector<Body> pistons_;
  std::vector<Contact> contacts_;  // of each ball, in the order of its directions
  // The contacts of each piston: with the ball before it and with the one after it.
  std::vector<std::array<size_t, 2>> sides_;
  // 2 J and 2 J' at the present energies, in the units of conductivity/contact_currents.h.
  double current_ = 0;
  double current_left_ = 0;
  double since_ = 0;
  CurrentSteps steps_;
  CurrentSteps steps_left_;
};

}  // namespace ballpiston
