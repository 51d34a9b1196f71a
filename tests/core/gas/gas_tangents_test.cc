#include "core/gas/gas_tangents.h"

#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tools/flows/precise_flow.h"  // boost/multiprecision

namespace ballpiston {
namespace {

using Vector = GasTangents::Vector;

// In the order of a vector's components.
Vector ComponentsOf(const GasState& state) {
  Vector components;
  for (const GasBall& ball : state.balls) {
    const Eigen::Vector2d velocity = ball.speed * ball.direction;
    for (const double x : {ball.position.x(), ball.position.y(), velocity.x(), velocity.y()}) {
      components.push_back(x);
    }
  }
  for (const GasPiston& piston : state.pistons) {
    components.insert(components.end(), {piston.offset, piston.velocity});
  }
  return components;
}

GasState StateWith(const Vector& components, GasState state) {
  auto at = components.begin();
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

Vector Sum(const Vector& a, double factor, const Vector& b) {
  Vector sum = a;
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += factor * b[i];
  return sum;
}

double Product(const Vector& a, const Vector& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

struct OrbitEnd {
  std::vector<std::tuple<EventKind, int64_t, int64_t>> events;
  size_t exchanges = 0;
  Vector components;
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
  GasTangents tangents(geometry, start, vectors);
  while (gas.NextTime() <= time) {
    const GasEvent event = gas.Step();
    tangents.Follow(event, gas);
  }
  return tangents.TakeGrowth(time);
}

// The difference of two orbits that start apart by twice `apart` along `vector`, over this
// distance. Empty if their events differ.
Vector DifferenceAlong(const Vector& vector, double time, const GasGeometry& geometry,
                       const GasState& start) {
  constexpr double kApart = 1e-7;
  const auto orbit = [&](double distance) {
    return OrbitTo(time, geometry, StateWith(Sum(ComponentsOf(start), distance, vector), start));
  };
  const OrbitEnd forward = orbit(kApart), back = orbit(-kApart);
  if (forward.events != back.events) return {};
  Vector difference = Sum(forward.components, -1, back.components);
  for (double& component : difference) component /= 2 * kApart;
  return difference;
}

// Growth up to exp(6). The differences have a rounding of 1e-16 exp(6)/1e-7 and a third order of
// (1e-7 exp(6))^2 times the curvature of fronts; grazing hits have the largest.
TEST(GasTangents, NearbyGasesDivergeAsPredicted) {
  size_t exchanges = 0, compared = 0;
  for (const char* const shape : {"1", "2", "3", "2x2"}) {
    const GasGeometry geometry = GasAtShare(0.53, 0.95, shape);
    for (uint64_t sample = 0; sample < 40; ++sample) {
      const GasState start = GasInEquilibrium(geometry, 1, 31, sample);
      const std::vector<Vector> across = VelocitiesAcross(geometry, start);
      const double time = 1.2;
      const Vector growth = GrowthTo(time, geometry, start, {across[0], across[1]});
      const Vector a = DifferenceAlong(across[0], time, geometry, start);
      const Vector b = DifferenceAlong(across[1], time, geometry, start);
      if (growth[0] > 6 || growth[1] > 6 || a.empty() || b.empty()) continue;
      const double aa = Product(a, a), ab = Product(a, b);
      EXPECT_NEAR(growth[0], std::log(aa) / 2, 1e-4) << shape << " " << sample;
      EXPECT_NEAR(growth[1], std::log(Product(b, b) - ab * ab / aa) / 2, 1e-4)
          << shape << " " << sample;
      exchanges += OrbitTo(time, geometry, start).exchanges;
      ++compared;
    }
  }
  EXPECT_GT(compared, 60u);
  EXPECT_GT(exchanges, 40u);
}

std::vector<Vector> WholeBasis(const GasGeometry& geometry) {
  std::vector<Vector> basis(2 * DegreesOfFreedom(geometry), Vector(2 * DegreesOfFreedom(geometry)));
  for (size_t k = 0; k < basis.size(); ++k) basis[k][k] = 1;
  return basis;
}

// The maps preserve volumes, so the sum is 0 but for rounding, which costs the smallest vector the
// most digits. The exponents of a finite orbit are pairs up to the growth while vectors of nearly
// equal exponents turn, which is 70 at most here.
TEST(GasTangents, ExponentsOfAGasComeInPairs) {
  for (const char* const shape : {"1", "2", "2x2"}) {
    const GasGeometry geometry = GasAtShare(0.53, 0.95, shape);
    const double time = 5000;
    const Vector growth =
        GrowthTo(time, geometry, GasInEquilibrium(geometry, 1, 32, 0), WholeBasis(geometry));
    const size_t f = DegreesOfFreedom(geometry);
    EXPECT_NEAR(std::accumulate(growth.begin(), growth.end(), 0.0) / time, 0, 1e-7);
    for (size_t k = 0; k < f; ++k) {
      EXPECT_NEAR((growth[k] + growth[2 * f - 1 - k]) / time, 0, 0.02) << shape << " " << k;
    }
    EXPECT_NEAR(growth[f - 1] / time, 0, 0.02) << shape;
    EXPECT_GT(growth[f - 2] / time, 0.03) << shape;
  }
}

// ---- many digits ----

// Below the rest of the last vector is exp(-800) of its length: 1,300 bits, and then 700 more.
using Exact = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<2000, boost::multiprecision::digit_base_2>>;
using ExactVector = std::vector<Exact>;

// All vectors in Cartesian components, without Gram and Schmidt's method until the end.
class CartesianTangents {
 public:
  CartesianTangents(const GasGeometry& geometry, const std::vector<Vector>& vectors)
      : balls_(static_cast<size_t>(geometry.balls())),
        rho_(geometry.pair().rho()),
        times_(balls_ + static_cast<size_t>(geometry.pistons())) {
    for (const Vector& vector : vectors) vectors_.emplace_back(vector.begin(), vector.end());
  }

  void Follow(const GasEvent& event, const ReferenceGas& gas) {
    if (event.ball >= 0) Move(static_cast<size_t>(event.ball), event.time);
    if (event.piston >= 0) Move(balls_ + static_cast<size_t>(event.piston), event.time);
    if (event.kind == EventKind::kBallWall) {
      Reflect(First(static_cast<size_t>(event.ball)), gas.BallAt(event.ball, event.time));
    }
    const size_t piston = First(balls_ + static_cast<size_t>(std::max<int64_t>(event.piston, 0)));
    const size_t ball = First(static_cast<size_t>(std::max<int64_t>(event.ball, 0)));
    const size_t axis = IsAlongX(event.direction) ? 0 : 1;
    for (ExactVector& v : vectors_) {
      if (event.kind == EventKind::kPistonWall) {
        v[piston] = -v[piston];
        v[piston + 1] = -v[piston + 1];
      } else if (event.kind == EventKind::kBallPiston) {
        std::swap(v[ball + axis], v[piston]);
        std::swap(v[ball + 2 + axis], v[piston + 1]);
      }
    }
  }

  // The logarithms of the factors by which the vectors have grown since the start.
  Vector GrowthAt(double time) {
    for (size_t body = 0; body < times_.size(); ++body) Move(body, time);
    Vector growth;
    std::vector<ExactVector> rest = vectors_;
    for (size_t k = 0; k < rest.size(); ++k) {
      const Exact squared = Product(rest[k], rest[k]);
      growth.push_back(log(squared).convert_to<double>() / 2);
      for (size_t j = k + 1; j < rest.size(); ++j) {
        const Exact share = Product(rest[k], rest[j]) / squared;
        for (size_t i = 0; i < rest[j].size(); ++i) rest[j][i] -= share * rest[k][i];
      }
    }
    return growth;
  }

 private:
  static Exact Product(const ExactVector& a, const ExactVector& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), Exact(0));
  }

  // Of the body's components.
  size_t First(size_t body) const { return body < balls_ ? 4 * body : 2 * (balls_ + body); }

  void Move(size_t body, double time) {
    const double wait = time - std::exchange(times_[body], time);
    const size_t first = First(body), positions = body < balls_ ? 2 : 1;
    for (ExactVector& v : vectors_) {
      for (size_t i = first; i < first + positions; ++i) v[i] += wait * v[i + positions];
    }
  }

  // billiard/tangent_map.h.
  void Reflect(size_t first, const GasBall& after) {
    const Eigen::Vector2d centre(std::copysign(0.5, after.position.x()),
                                 std::copysign(0.5, after.position.y()));
    const Eigen::Vector2d n = (after.position - centre) / rho_, t(-n.y(), n.x());
    const Eigen::Vector2d& u = after.direction;
    const double slope = u.dot(t) / u.dot(n), kick = 2 * after.speed / rho_;
    for (ExactVector& v : vectors_) {
      Exact &x = v[first], &y = v[first + 1], &vx = v[first + 2], &vy = v[first + 3];
      const Exact across = x * n.x() + y * n.y(), velocity = vx * n.x() + vy * n.y();
      const Exact turn = kick * (x * t.x() + y * t.y() + slope * across);
      x -= 2 * across * n.x();
      y -= 2 * across * n.y();
      vx -= 2 * velocity * n.x() + turn * u.y();
      vy -= 2 * velocity * n.y() - turn * u.x();
    }
  }

  size_t balls_;
  double rho_;
  std::vector<double> times_;
  std::vector<ExactVector> vectors_;
};

// The first exponent, the sum of those of the balls, and each slower one. Rounding decides when the
// second and the third vector change places. A growth of 900 has a rounding of some 1e-10.
TEST(GasTangents, GrowthsAreThoseOfManyDigits) {
  const GasGeometry geometry = GasOf(0.53, 0.05, "3");
  for (const uint64_t sample : {0, 3}) {
    const GasState start = GasInEquilibrium(geometry, 1, 34, sample);
    const std::vector<Vector> across = VelocitiesAcross(geometry, start);
    ReferenceGas gas(geometry, start, ThermalWalls());
    GasTangents tangents(geometry, start, across);
    CartesianTangents exact(geometry, across);
    const double time = 120;
    while (gas.NextTime() <= time) {
      const GasEvent event = gas.Step();
      tangents.Follow(event, gas);
      exact.Follow(event, gas);
    }
    const Vector growth = tangents.TakeGrowth(time), expected = exact.GrowthAt(time);
    EXPECT_NEAR(growth[0], expected[0], 1e-8);
    EXPECT_NEAR(growth[1] + growth[2], expected[1] + expected[2], 1e-8);
    for (size_t k = 3; k < growth.size(); ++k) EXPECT_NEAR(growth[k], expected[k], 1e-8) << k;
  }
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
      GasTangents tangents(geometry, start, {vector});
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

TEST(GasTangents, VelocitiesAcrossKeepTheEnergy) {
  const GasGeometry geometry = GasAtShare(0.53, 0.5, "2x2");
  const GasState start = GasInEquilibrium(geometry, 1, 33, 0);
  const std::vector<Vector> across = VelocitiesAcross(geometry, start);
  ASSERT_EQ(across.size(), DegreesOfFreedom(geometry) - 1);
  const double energy = EnergyOf(start);
  for (const Vector& vector : across) {
    const GasState moved = StateWith(Sum(ComponentsOf(start), 1e-5, vector), start);
    EXPECT_NEAR(EnergyOf(moved), energy, 1e-9);
  }
}

}  // namespace
}  // namespace ballpiston
