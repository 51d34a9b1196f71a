#include "core/closed_form/kernel.h"

#include "tests/core/preamble.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

Quad Positive(Quad x) { return x > 0 ? x : Quad{0}; }

// The first form of eq. kernel: the sum over the piston's signs before and after.
Quad KernelOverSigns(Quad eb, Quad ep, Quad ep_out) {
  if (ep_out >= eb) return 0;
  Quad sum = 0;
  for (int before : {1, -1}) {
    for (int after : {1, -1}) sum += Positive(after * Sqrt(ep_out) - before * Sqrt(ep));
  }
  return sum / (4 * QuadPi() * Sqrt(ep_out) * Sqrt(eb - ep_out));
}

TEST(Kernel, AccurateAtRandomEnergies) {
  std::mt19937_64 random(20240607);
  std::uniform_real_distribution<double> exponent(-14, 0);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const double small = 0.5 * std::pow(10, exponent(random));
    const double ep = i % 2 == 0 ? small : 0.5 - small;
    const double out = 0.5 * unit(random);
    EXPECT_LE(RelativeError(PairKernel(ep, out), KernelOverSigns(Quad{1} / 2 - Quad{ep}, ep, out)),
              kKernelRelativeError);
    EXPECT_LE(RelativeError(Kernel(small, ep, out), KernelOverSigns(small, ep, out)),
              kKernelRelativeError);
  }
}

TEST(Kernel, AccurateWhereTheBallKeepsLittleEnergy) {
  double worst_printed = 0;
  std::mt19937_64 random(20240608);
  std::uniform_real_distribution<double> exponent(-17, -1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 5000; ++i) {
    // Every third pair of energies close to (1/4, 1/4), where 1/2 - ep loses a bit.
    const double ep =
        i % 3 == 0 ? 0.25 - 0.25 * std::pow(10, exponent(random)) : 0.5 * unit(random);
    const double out = (0.5 - ep) * (1 - std::pow(10, exponent(random)));
    const Quad exact = KernelOverSigns(Quad{1} / 2 - Quad{ep}, ep, out);
    EXPECT_LE(RelativeError(PairKernel(ep, out), exact), kKernelRelativeError) << ep << " " << out;
    const double printed = KernelAsPrinted(0.5 - ep, ep, out, M_PI);
    worst_printed = std::max(worst_printed, RelativeError(printed, exact));
  }
  EXPECT_GT(worst_printed, 1e-3);  // the printed formula fails at these points
  const double below = std::nextafter(0.25, 0.0);
  EXPECT_LE(RelativeError(PairKernel(below, below),
                          KernelOverSigns(Quad{1} / 2 - Quad{below}, below, below)),
            kKernelRelativeError);
}

TEST(Kernel, ValuesAtTheEdgesOfItsDomain) {
  // Beyond the ball's energy.
  for (const double value : {Kernel(0.2, 0.3, 0.2), Kernel(0.2, 0.3, 0.21), PairKernel(0.1, 0.4),
                             PairKernel(0.1, 0.45), PairKernel(0.5, 1e-12)}) {
    EXPECT_EQ(value, 0);
  }
  // Where the piston ends at rest.
  EXPECT_EQ(Kernel(0.3, 0.1, 0), HUGE_VAL);
  EXPECT_DOUBLE_EQ(Kernel(0.25, 0, 0), 1 / M_PI);
  EXPECT_DOUBLE_EQ(Kernel(0.25, 0, 1e-320), 1 / M_PI);
  EXPECT_DOUBLE_EQ(PairKernel(0.25, 1e-310), 1 / (2 * M_PI * std::sqrt(1e-310)));
}

}  // namespace
}  // namespace ballpiston
