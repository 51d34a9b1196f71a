#include "core/closed_form/kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ballpiston {
namespace {

// `rest` is eb - ep_out: the ball's energy after the collision minus the piston's energy before it.
double KernelWithRest(double ep, double ep_out, double rest) {
  if (rest <= 0) return 0;
  // max(sqrt ep_out, sqrt ep)/sqrt(ep_out), without 0/0 when both vanish. ep/ep_out may overflow.
  const double ratio = ep_out >= ep ? 1 : std::sqrt(ep) / std::sqrt(ep_out);
  return ratio / (2 * std::numbers::pi * std::sqrt(rest));
}

// 1/2 - ep - ep_out. Both steps are exact if the result is small, except that 1/2 - larger can lose
// the last bit of a number below 1/4; this bit is added again.
double PairRest(double ep, double ep_out) {
  const double larger = std::max(ep, ep_out);
  const double smaller = std::min(ep, ep_out);
  const double rest = 0.5 - larger;
  const double dropped = (0.5 - rest) - larger;
  return (rest - smaller) + dropped;
}

}  // namespace

double Kernel(double eb, double ep, double ep_out) {
  return KernelWithRest(ep, ep_out, eb - ep_out);
}

double PairKernel(double ep, double ep_out) {
  return KernelWithRest(ep, ep_out, PairRest(ep, ep_out));
}

}  // namespace ballpiston
