#include "tools/stability/gas_look_back.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "tools/flows/metered_gases.h"

namespace ballpiston::stability {
namespace {

constexpr double kGasEpsilon = std::numeric_limits<double>::epsilon();
constexpr uint64_t kNeighbourSeed = 25;

// A neighbouring start: every number is changed by at most `most`.
GasState Moved(double most, const GasGeometry& geometry, GasState state, CounterRandom& random) {
  const auto off = [&] { return most * (2 * random.Uniform() - 1); };
  const double reach = geometry.reach();
  for (GasBall& ball : state.balls) {
    ball.position += Eigen::Vector2d(off(), off());
    ball.direction = (ball.direction + Eigen::Vector2d(off(), off())).normalized();
  }
  for (GasPiston& piston : state.pistons) {
    piston.offset = std::clamp(piston.offset + off(), -reach, reach);
  }
  return state;
}

GasReading ByReference(const GasGeometry& geometry, const GasStart& replica, double time) {
  MeteredGases gases(GasEngine::kReference, geometry, {replica});
  gases.AdvanceTo(time);
  return ReadingOf(gases.meters().front());
}

double Distance(const GasReading& a, const GasReading& b) {
  double distance = 0;
  for (size_t i = 0; i < a.energies.size(); ++i) {
    distance = std::max(distance, ErrorSize(a.energies[i] - b.energies[i]));
  }
  return distance;
}

// Compares the reading with the reference, from the same start and, at each scale, from `each`
// neighbouring starts.
Failures AsNeighboursTell(const GasGeometry& geometry, const GasStart& replica, double time,
                          const GasReading& reading, std::span<const double> scales, int each) {
  const GasReading middle = ByReference(geometry, replica, time);
  CounterRandom random(kNeighbourSeed, 0, 0);
  double nearest = Distance(reading, middle), spread = 0;
  for (const double scale : scales) {
    for (int i = 0; i < each; ++i) {
      GasStart moved = replica;
      moved.state = Moved(scale * kGasEpsilon, geometry, replica.state, random);
      const GasReading other = ByReference(geometry, moved, time);
      nearest = std::min(nearest, Distance(reading, other));
      spread = std::max(spread, Distance(middle, other));
    }
  }
  Failures found;
  // Two neighbours differ by at most twice their largest difference from the middle.
  if (nearest <= 1e4 * kGasEpsilon * middle.Total() + 2 * spread) return found;
  (reading.exchanges < middle.exchanges ? found.missed : found.phantoms) = 1;
  return found;
}

}  // namespace

double GasReading::Total() const {
  double sum = 0;
  for (const double energy : energies) sum += energy;
  return sum;
}

GasReading ReadingOf(const GasMeter& meter) {
  GasReading reading = {.energies = {}, .exchanges = meter.exchanges()};
  for (size_t i = 0; i < meter.bodies(); ++i) reading.energies.push_back(meter.Energy(i));
  return reading;
}

Failures LookBack(const GasGeometry& geometry, const GasStart& replica, double time,
                  const GasReading& reading) {
  static constexpr std::array<double, 1> kBeyondRounding = {64};
  static constexpr std::array<double, 4> kScales = {1, 4, 16, 64};
  Failures found = AsNeighboursTell(geometry, replica, time, reading, kBeyondRounding, 2);
  // The middle has rounding errors too. In a tip, or for a grazing ball, an ulp decides, and two
  // neighbours are not enough.
  if (found.Total() > 0) found = AsNeighboursTell(geometry, replica, time, reading, kScales, 500);
  found.looked_back = reading.exchanges;
  return found;
}

Failures LookAtEnergies(const GasGeometry& geometry, const GasMeter& meter, double start) {
  const GasReading reading = ReadingOf(meter);
  const bool is_valid = std::ranges::all_of(
      reading.energies, [](double energy) { return energy >= 0 && std::isfinite(energy); });
  Failures found;
  found.orbits = 1;
  found.hits = reading.exchanges;
  found.escapes = meter.escapes() + (is_valid ? 0 : 1);
  if (geometry.ends() == GasEnds::kPeriodic) {
    found.SeeEnergy(std::fabs(reading.Total() / start - 1));
  }
  return found;
}

}  // namespace ballpiston::stability
