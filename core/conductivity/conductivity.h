// The heat conductivity of infinite chains and lattices in the limit of rare collisions.
//
// Energy moves by the jump process. Two sites a and b, a ball and a piston, exchange their velocity
// components v_a and v_b along their contact, at the rate (v_a - v_b)+. The static conductivity
// kappa_0 is half of the exchange rate. Correlations lower the conductivity kappa. The correction
// kappa/kappa_0 - 1 is a universal number for each lattice: it is independent of the temperature
// and of the cell's shape. So it is a constant here; tools/conductivity computes it by Varadhan's
// variational formula. docs/research/conductivity.md has the tables.
#pragma once

#include "core/arithmetic/bounded_value.h"

namespace ballpiston {

// The exchange rate <(v_a - v_b)+> = 1/sqrt(pi), at a contact's density 1, mass 1, temperature 1.
inline constexpr double kContactRate = 0.5641895835477563;

// kappa/kappa_0 - 1 of the infinite gases. The error is the change of the extrapolated value by its
// last term. Tests: Conductivity.QuickPlanAgreesWithTheConstants, and
// by night Conductivity.FinePlanGivesTheConstants.
inline constexpr BoundedValue kChainCorrection = {-0.0018073, 4e-7};
inline constexpr BoundedValue kLatticeCorrection = {-0.0011937, 2e-7};

}  // namespace ballpiston
