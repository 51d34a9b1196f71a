#include "core/gas/gas_tangents.h"

#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

using Vector = GasTangents::Vector;

GasState StateWith(const Eigen::VectorXd& components, GasState state) {
  const double* at = components.data();
  for (GasBall& ball : state.balls) {
    ball.position = {at[0], at[1]};
    const Eigen::Vector2d velocity(at[2], at[3]);
    ball.speed = velocity.norm();
    ball.direction = velocity / ball.speed;
    at += 4;
  }
  for (GasPiston& piston : state.pistons) {
    piston = {.offset = at[0], .velocity = at[1]};
    at += 2;
  }
  return state;
}

struct OrbitEnd {
  std::vector<std::tuple<EventKind, int64_t, int64_t>> events;
  size_t exchanges = 0;
  Eigen::VectorXd components;
};

OrbitEnd OrbitTo(double time, const GasGeometry& geometry, const GasState& start) {
  ReferenceGas gas(geometry, start, ThermalWalls());
  OrbitEnd end;
  while (gas.NextTime() <= time) {
    const GasEvent event = gas.Step();
    end.events.emplace_back(event.kind, event.ball, event.piston);
    if (event.kind == EventKind::kBallPiston) ++end.exchanges;
  }
  end.components = ComponentsOf(gas.StateAt(time));
  return end;
}

Vector GrowthTo(double time, const GasGeometry& geometry, const GasState& start,
                const std::vector<Vector>& vectors) {
  ReferenceGas gas(geometry, start, ThermalWalls());
  GasTangents tangents(geometry.pair().rho(), start, vectors);
  while (gas.NextTime() <= time) {
    const GasEvent event = gas.Step();
    tangents.Follow(event, gas);
  }
  return tangents.TakeGrowth(time);
}

// The difference of two orbits that start apart by twice `apart` along `vector`, over this
// distance. Empty if their events differ.
Eigen::VectorXd DifferenceAlong(const Vector& vector, double time, const GasGeometry& geometry,
                                const GasState& start) {
  constexpr double kApart = 1e-7;
  const Eigen::Map<const Eigen::VectorXd> along(vector.data(), std::ssize(vector));
  const auto orbit = [&](double distance) {
    return OrbitTo(time, geometry, StateWith(ComponentsOf(start) + distance * along, start));
  };
  const OrbitEnd forward = orbit(kApart), back = orbit(-kApart);
  if (forward.events != back.events) return {};
  return (forward.components - back.components) / (2 * kApart);
}

// Growth up to exp(6). The differences have a rounding of 1e-16 exp(6)/1e-7 and a third order of
// (1e-7 exp(6))^2 times the curvature of fronts; grazing hits have the largest.
TEST(GasTangents, NearbyGasesDivergeAsPredicted) {
  size_t exchanges = 0, compared = 0;
  for (const char* const shape : {"1", "2", "3", "2x2"}) {
    const GasGeometry geometry = GasAtShare(0.53, 0.95, shape);
    for (uint64_t sample = 0; sample < 40; ++sample) {
      const GasState start = GasInEquilibrium(geometry, 1, 31, sample);
      const std::vector<Vector> across = VelocitiesAcross(start);
      const double time = 1.2;
      const Vector growth = GrowthTo(time, geometry, start, {across[0], across[1]});
      const Eigen::VectorXd a = DifferenceAlong(across[0], time, geometry, start);
      const Eigen::VectorXd b = DifferenceAlong(across[1], time, geometry, start);
      if (growth[0] > 6 || growth[1] > 6 || a.size() == 0 || b.size() == 0) continue;
      const double aa = a.dot(a), ab = a.dot(b);
      EXPECT_NEAR(growth[0], std::log(aa) / 2, 1e-4) << shape << " " << sample;
      EXPECT_NEAR(growth[1], std::log(b.dot(b) - ab * ab / aa) / 2, 1e-4) << shape << " " << sample;
      exchanges += OrbitTo(time, geometry, start).exchanges;
      ++compared;
    }
  }
  EXPECT_GT(compared, 60u);
  EXPECT_GT(exchanges, 40u);
}

// Vectors that start with the velocity of one ball turn to the direction of the first exponent. The
// components of each of them at slower balls become as small as exp(-1000); they grow again when
// such a ball becomes the faster one.
TEST(GasTangents, SmallComponentsAreKept) {
  const GasGeometry geometry = GasOf(0.53, 0.02, "4");
  for (uint64_t sample = 0; sample < 4; ++sample) {
    const GasState start = GasInEquilibrium(geometry, 1, 34, sample);
    std::vector<double> grown;
    for (const size_t ball : {0u, 2u}) {
      Vector vector(2 * DegreesOfFreedom(geometry));
      vector[4 * ball + 2] = 1;
      ReferenceGas gas(geometry, start, ThermalWalls());
      GasTangents tangents(geometry.pair().rho(), start, {vector});
      for (const double time : {10'000.0, 20'000.0}) {
        while (gas.NextTime() <= time) {
          const GasEvent event = gas.Step();
          tangents.Follow(event, gas);
        }
        grown.push_back(tangents.TakeGrowth(time)[0]);
      }
    }
    EXPECT_NEAR(grown[1], grown[3], 1e-6);
  }
}

}  // namespace
}  // namespace ballpiston
