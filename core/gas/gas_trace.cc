#include <cmath>

#include "core/gas/free_times.h"
#include "core/gas/reference_gas.h"
#include "core/gas/trace.h"

namespace ballpiston {
namespace {

constexpr size_t kSides = 4;  // of a cell, by Direction

template <typename Body>
std::vector<double> EnergiesOf(const std::vector<Body>& bodies) {
  std::vector<double> energies;
  energies.reserve(bodies.size());
  for (const Body& body : bodies) energies.push_back(EnergyOf(body));
  return energies;
}

class GasTrace : public Trace {
 public:
  GasTrace(const GasGeometry& geometry, const GasState& start)
      : geometry_(geometry),
        gas_(geometry, start, ThermalWalls()),
        ball_energies_(EnergiesOf(start.balls)),
        piston_energies_(EnergiesOf(start.pistons)),
        free_times_(start.balls.size() * (kSides + 1) + start.pistons.size()) {}

  std::vector<TracedBody> Balls() const override {
    std::vector<TracedBody> balls;
    for (int64_t i = 0; i < geometry_.balls(); ++i) balls.push_back(BallAt(i, 0));
    return balls;
  }

  std::vector<TracedBody> Pistons() const override {
    std::vector<TracedBody> pistons;
    for (int64_t i = 0; i < geometry_.pistons(); ++i) pistons.push_back(PistonAt(i, 0));
    return pistons;
  }

  std::optional<TraceEvent> Next() override {
    if (!std::isfinite(gas_.NextTime())) return std::nullopt;
    const GasEvent event = gas_.Step();
    TraceEvent traced;
    traced.kind = event.kind;
    traced.time = event.time;
    traced.free_time = free_times_.Hit(SurfaceOf(event), event.time);
    if (event.ball >= 0) {
      traced.ball = Change(event.ball, BallAt(event.ball, event.time), ball_energies_);
    }
    if (event.piston >= 0) {
      traced.piston = Change(event.piston, PistonAt(event.piston, event.time), piston_energies_);
    }
    return traced;
  }

 private:
  TracedBody BallAt(int64_t i, double time) const {
    const GasBall ball = gas_.BallAt(i, time);
    return {geometry_.CentreOfCell(i) + ball.position, ball.speed * ball.direction, EnergyOf(ball)};
  }

  TracedBody PistonAt(int64_t i, double time) const {
    const GasPiston piston = gas_.PistonAt(i, time);
    const bool is_along_x = geometry_.IsAlongX(i);
    const auto along = [&](double v) {
      return is_along_x ? Eigen::Vector2d(v, 0) : Eigen::Vector2d(0, v);
    };
    return {geometry_.MiddleOfEdge(i) + along(piston.offset), along(piston.velocity),
            EnergyOf(piston)};
  }

  static TracedChange Change(int64_t i, const TracedBody& after, std::vector<double>& energies) {
    double& energy = energies[static_cast<size_t>(i)];
    const TracedChange change = {.index = i, .energy_before = energy, .after = after};
    energy = after.energy;
    return change;
  }

  // The ball's walls, its contacts on four sides, and after all balls the pistons' walls.
  size_t SurfaceOf(const GasEvent& event) const {
    if (event.ball < 0) {
      return ball_energies_.size() * (kSides + 1) + static_cast<size_t>(event.piston);
    }
    const size_t first = static_cast<size_t>(event.ball) * (kSides + 1);
    if (event.kind != EventKind::kBallPiston) return first;
    return first + 1 + static_cast<size_t>(event.direction);
  }

  GasGeometry geometry_;
  ReferenceGas gas_;
  std::vector<double> ball_energies_;
  std::vector<double> piston_energies_;
  FreeTimes free_times_;
};

}  // namespace

std::unique_ptr<Trace> TraceGas(const GasGeometry& geometry, const GasState& start) {
  return std::make_unique<GasTrace>(geometry, start);
}

}  // namespace ballpiston
