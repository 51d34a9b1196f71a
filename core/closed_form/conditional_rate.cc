#include "core/closed_form/conditional_rate.h"

#include "core/closed_form/kernel_moments.h"
#include "core/closed_form/mean_free_time.h"

namespace ballpiston {

// nu_bp(ep) = f |dG_bp|/|G| and tau_bp = 4 |G|/|dG_bp|.
double Phi(double ep) { return 4 * PairCollisionRate(ep); }

double ConditionalMeanFreeTime(const PairGeometry& geometry, double ep) {
  return MeanFreeTimesOf(geometry).ball_piston / Phi(ep);
}

}  // namespace ballpiston
