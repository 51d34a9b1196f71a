#include "tools/stability/gas_look_back.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "core/gas/gas_run.h"
#include "tools/stability/error_size.h"

namespace ballpiston::stability {
namespace {

constexpr double kGasEpsilon = std::numeric_limits<double>::epsilon();

// A neighbour of a start is off by so many steps: all directions turned, and all pistons along x
// and all along y shifted, so that walls and pistons that cross come in any order.
struct Neighbour {
  double step;
  int turn;
  int shift_x;
  int shift_y;
};

void Move(const Neighbour& neighbour, const GasGeometry& geometry, GasState& state) {
  const double angle = neighbour.step * neighbour.turn, reach = geometry.reach();
  for (GasBall& ball : state.balls) {
    const Eigen::Vector2d u = ball.direction;
    ball.direction = (u + angle * Eigen::Vector2d(-u.y(), u.x())).normalized();
  }
  for (int64_t i = 0; i < geometry.pistons(); ++i) {
    const int steps = geometry.IsAlongX(i) ? neighbour.shift_x : neighbour.shift_y;
    GasPiston& piston = state.pistons[static_cast<size_t>(i)];
    piston.offset = std::clamp(piston.offset + neighbour.step * steps, -reach, reach);
  }
}

GasReading ByReference(const GasGeometry& geometry, const GasReplica& replica, double time) {
  GasMeter meter(geometry, replica.state);
  StartGases(GasEngine::kReference, geometry, 1,
             {GasStart{replica.state, replica.walls, replica.random, &meter}})
      ->AdvanceTo(time);
  return ReadingOf(meter);
}

double Distance(const GasReading& a, const GasReading& b) {
  double distance = 0;
  for (size_t i = 0; i < a.energies.size(); ++i) {
    distance = std::max(distance, ErrorSize(a.energies[i] - b.energies[i]));
  }
  return distance;
}

// What the reference tells of a start and of some neighbours.
Failures AsNeighboursTell(const GasGeometry& geometry, const GasReplica& replica, double time,
                          const GasReading& reading, std::span<const Neighbour> neighbours) {
  const GasReading middle = ByReference(geometry, replica, time);
  double nearest = Distance(reading, middle), spread = 0;
  for (const Neighbour& neighbour : neighbours) {
    GasReplica moved = replica;
    Move(neighbour, geometry, moved.state);
    const GasReading other = ByReference(geometry, moved, time);
    nearest = std::min(nearest, Distance(reading, other));
    spread = std::max(spread, Distance(middle, other));
  }
  Failures found;
  // The neighbours differ from each other by at most twice what they differ from the middle.
  if (nearest <= 1e4 * kGasEpsilon * middle.Total() + 2 * spread) return found;
  (reading.exchanges < middle.exchanges ? found.missed : found.phantoms) = 1;
  return found;
}

// All within so many steps.
void AddNeighbours(double step, int steps, std::vector<Neighbour>& neighbours) {
  for (int turn = -steps; turn <= steps; ++turn) {
    for (int x = -steps; x <= steps; ++x) {
      for (int y = -steps; y <= steps; ++y) neighbours.push_back({step, turn, x, y});
    }
  }
}

// Near ones too: in a tip some ulps decide how often ball and piston meet.
std::vector<Neighbour> ManyNeighbours() {
  std::vector<Neighbour> neighbours;
  for (const double step : {4.0, 64.0, 1e3}) AddNeighbours(step * kGasEpsilon, 4, neighbours);
  return neighbours;
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

Failures LookBack(const GasGeometry& geometry, const GasReplica& replica, double time,
                  const GasReading& reading) {
  static constexpr std::array<Neighbour, 2> kNearest = {
      {{1e3 * kGasEpsilon, -1, -1, 1}, {1e3 * kGasEpsilon, 1, 1, -1}}};
  Failures found = AsNeighboursTell(geometry, replica, time, reading, kNearest);
  // The middle is rounded too: where it grazes, two neighbours tell too little.
  if (found.Total() > 0) {
    found = AsNeighboursTell(geometry, replica, time, reading, ManyNeighbours());
  }
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
