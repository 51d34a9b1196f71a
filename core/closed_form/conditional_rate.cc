#include "core/closed_form/conditional_rate.h"

#include "core/closed_form/kernel_moments.h"
#include "core/closed_form/pair_measures.h"

namespace ballpiston {
namespace {

double VisitedVolume(const PairGeometry& geometry, double ep) {
  if (ep == 0) return VolumesAtRest(geometry).piston;
  if (ep == 0.5) return VolumesAtRest(geometry).ball;
  return Measures(geometry).volume;
}

}  // namespace

// nu_bp(ep) = f |dG_bp|/|G| and tau_bp = 4 |G|/|dG_bp|.
double Phi(double ep) { return 4 * PairCollisionRate(ep); }

double ConditionalMeanFreeTime(const PairGeometry& geometry, double ep) {
  return 4 * VisitedVolume(geometry, ep) / (Measures(geometry).area_ball_piston * Phi(ep));
}

}  // namespace ballpiston
