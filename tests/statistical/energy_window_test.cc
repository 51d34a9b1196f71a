// A series of ball-piston collisions in equilibrium, and among them the collisions after which the
// piston's energy is in a window around ep. The quotient in the paper's eq. taumftepdelta, the mean
// return time after such a collision over the width of the window, has no limit as the width falls.
// Two other quantities have a limit:
//
//   mean return time after a collision in the window     -> tau(ep)
//   mean time between two such collisions, times width   -> sqrt(2 ep) tau(ep)
//
// The energies after collisions have the density phi(e)/sqrt(2 e) (eq. intcnuep). After a collision
// with the final energy e the mean return time is tau(e) = tau_bp/phi(e). So in a window (a, b)
//
//   mean return time = tau_bp (sqrt(2 b) - sqrt(2 a))/share,  spacing = tau_bp/share,
//   share = int_a^b phi(e)/sqrt(2 e) de,
//
// exactly, for every delta and every width. The factor sqrt(2 ep), the piston's speed, is the
// inverse of the equilibrium density of the piston's energy.
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/mean_free_time.h"
#include "core/sampling/invariant_measure.h"
#include "core/statistics/batch_means.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tests/support/nightly.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston {
namespace {

struct EnergyWindow {
  double energy;
  double width;

  double Bottom() const { return energy - width / 2; }
  double Top() const { return energy + width / 2; }
  bool Holds(double ep) const { return Bottom() < ep && ep < Top(); }
};

const std::vector<EnergyWindow> kEnergyWindows = {{0.125, 0.2},   {0.125, 0.1},  {0.125, 0.05},
                                                  {0.125, 0.025}, {0.375, 0.2},  {0.375, 0.1},
                                                  {0.375, 0.05},  {0.375, 0.025}};

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

const uint64_t kWindowOrbits = IsNightly() ? 20'000 : 10'000;
constexpr uint64_t kCollisionsAnOrbit = 200;

// Sums over an orbit that starts just after a collision.
class WindowOrbits : public NumberedOrbits {
 public:
  WindowOrbits() : orbits_(kWindowOrbits) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random(20250118, 0, orbit);
    PairState state = DrawFromCollisionMeasure(kPaperPair, random);
    orbits_[orbit].energy = state.piston_velocity * state.piston_velocity / 2;
    return state;
  }

  AfterCollision Collide(uint64_t number, const Collision& collision) override {
    EXPECT_FALSE(collision.escaped);
    Orbit& orbit = orbits_[number];
    for (size_t i = 0; i < kEnergyWindows.size(); ++i) {
      if (!kEnergyWindows[i].Holds(orbit.energy)) continue;
      orbit.returns[i] += collision.time;
      ++orbit.events[i];
    }
    orbit.time += collision.time;
    // The piston takes the ball's velocity along x.
    const double velocity = collision.state.ball_speed * collision.state.direction.x();
    orbit.energy = velocity * velocity / 2;
    return ++orbit.collisions < kCollisionsAnOrbit ? AfterCollision::kGoOn : AfterCollision::kEnd;
  }

  BatchMeans ReturnTimes(size_t window) const {
    BatchMeans means;
    for (const Orbit& orbit : orbits_) means.Add(orbit.returns[window], orbit.events[window]);
    return means;
  }

  BatchMeans Spacings(size_t window) const {
    BatchMeans means;
    for (const Orbit& orbit : orbits_) means.Add(orbit.time, orbit.events[window]);
    return means;
  }

 private:
  struct Orbit {
    double energy = 0;  // of the piston, after the latest collision
    double time = 0;
    uint64_t collisions = 0;
    std::vector<double> returns = std::vector<double>(kEnergyWindows.size());
    std::vector<double> events = std::vector<double>(kEnergyWindows.size());
  };

  std::vector<Orbit> orbits_;
};

const WindowOrbits& SampledWindows() {
  static const WindowOrbits* const orbits = [] {
    auto* sampled = new WindowOrbits;
    EXPECT_TRUE(RunOrbits(Engine::kLanes, kPaperPair, kWindowOrbits, *sampled));
    return sampled;
  }();
  return *orbits;
}

double ZScoreOf(const BatchMeans& measured, double exact) {
  return (*measured.Ratio() - exact) / *measured.StandardError();
}

// Within 4 standard errors, each 0.1 to 0.45 % of the value (nightly 0.07 to 0.3 %): 16
// comparisons, 6e-5 false alarms each, one false alarm in 1000 choices of the seed.
TEST(EnergyWindows, SampledTimesMatchTheExactTimesOfTheWindow) {
  for (size_t i = 0; i < kEnergyWindows.size(); ++i) {
    const WindowTimes exact = ExactTimes(kEnergyWindows[i]);
    const BatchMeans returns = SampledWindows().ReturnTimes(i);
    const BatchMeans spacings = SampledWindows().Spacings(i);
    const double return_z = ZScoreOf(returns, exact.mean_return);
    const double spacing_z = ZScoreOf(spacings, exact.spacing);
    EXPECT_LT(std::fabs(return_z), 4) << "window " << i;
    EXPECT_LT(std::fabs(spacing_z), 4) << "window " << i;
  }
}

// Compares the narrowest windows with the limits. The difference of these windows from the limits
// is 0.13 % of the spacing and less of the mean return time (next test). False alarms as above.
TEST(EnergyWindows, SampledTimesOfNarrowWindowsAreNearTheirLimits) {
  for (const size_t i : {3u, 7u}) {
    const EnergyWindow& window = kEnergyWindows[i];
    const WindowTimes limit = Limits(window.energy);
    const BatchMeans returns = SampledWindows().ReturnTimes(i);
    const BatchMeans spacings = SampledWindows().Spacings(i);
    EXPECT_NEAR(*returns.Ratio(), limit.mean_return,
                4 * *returns.StandardError() + 0.0015 * limit.mean_return);
    EXPECT_NEAR(*spacings.Ratio() * window.width, limit.spacing,
                4 * *spacings.StandardError() * window.width + 0.0015 * limit.spacing);
    // The quotient that is printed is forty times tau(ep) at this width.
    EXPECT_GT(*returns.Ratio() / window.width, 39 * limit.mean_return);
  }
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
