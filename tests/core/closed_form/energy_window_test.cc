// Collisions after which the piston's energy is in a window (a, b) around ep: the paper's eq.
// taumftepdelta, which core/closed_form/README.md corrects. The energies after collisions have the
// density phi(e)/sqrt(2 e) (eq. intcnuep), and the mean return time is tau_bp/phi(e), so
//
//   mean return time = tau_bp (sqrt(2 b) - sqrt(2 a))/share,  spacing = tau_bp/share,
//   share = int_a^b phi(e)/sqrt(2 e) de,
//
// exactly, for every delta and every width.
#include "core/closed_form/mean_free_time.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"

namespace ballpiston {
namespace {

struct EnergyWindow {
  double energy;
  double width;

  double Bottom() const { return energy - width / 2; }
  double Top() const { return energy + width / 2; }
};

struct WindowTimes {
  double mean_return;
  double spacing;
};

// No window holds 1/4, where phi has a kink.
WindowTimes ExactTimes(const EnergyWindow& window) {
  const auto density = [](Quad e) {
    const double ep = static_cast<double>(e);
    return Phi(ep) / std::sqrt(2 * ep);
  };
  const double tau = MeanFreeTimesOf(kPaperPair).ball_piston;
  const double spacing =
      tau / static_cast<double>(oracle::Integrate(density, window.Bottom(), window.Top()));
  return {.mean_return = spacing * (std::sqrt(2 * window.Top()) - std::sqrt(2 * window.Bottom())),
          .spacing = spacing};
}

// The limits of mean_return and of spacing times width.
WindowTimes Limits(double energy) {
  const double tau = ConditionalMeanFreeTime(kPaperPair, energy);
  return {.mean_return = tau, .spacing = std::sqrt(2 * energy) * tau};
}

// The differences from the limits fall as the square of the width: half the width gives a quarter
// of the difference. Above 1/4 the spacing has no difference, because phi(e)/sqrt(2 e) is constant.
TEST(EnergyWindows, TimesTendToTheirLimitsAsTheSquareOfTheWidth) {
  for (const double energy : {0.03125, 0.125, 0.375, 0.45}) {
    const WindowTimes limit = Limits(energy);
    for (const double width : {0.02, 0.01, 0.005, 0.0025, 0.00125}) {
      const WindowTimes times = ExactTimes({energy, width});
      const double square = (width / energy) * (width / energy);
      EXPECT_NEAR(times.mean_return / limit.mean_return, 1, square / 20) << energy;
      EXPECT_NEAR(times.spacing * width / limit.spacing, 1, square / 20) << energy;
    }
  }
}

// The quotient that the paper prints doubles if the width is halved, so it has no limit.
TEST(EnergyWindows, MeanReturnTimeOverWidthGrowsWithoutBound) {
  const auto printed = [](double width) { return ExactTimes({0.125, width}).mean_return / width; };
  for (const double width : {0.1, 0.01, 1e-3, 1e-4}) {
    EXPECT_NEAR(printed(width / 2) / printed(width), 2, width);
  }
}

}  // namespace
}  // namespace ballpiston
