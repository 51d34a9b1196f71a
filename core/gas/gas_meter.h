// Measures a gas in a time window: the number of exchanges, the energy that is carried along x, and
// each body's mean energy. The engine reports its events to the meter, in the order of time.
// The meter forwards exchanges to a meter of the current, if it has one.
//
// Bodies are the balls, then the pistons. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/billiard/event_flow.h"
#include "core/gas/current_meter.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"

namespace ballpiston {

// A field that the event does not have keeps its default.
struct GasEvent {
  EventKind kind = EventKind::kEscape;
  double time = 0;
  int64_t ball = -1;                        // of a wall hit, an exchange or an escape
  int64_t piston = -1;                      // of a wall hit or an exchange
  Direction direction = Direction::kRight;  // in which the ball sees the piston
  double ball_energy = 0;                   // after an exchange
  double piston_energy = 0;                 // after an exchange or the piston's wall hit
};

class GasMeter {
 public:
  GasMeter(const GasGeometry& geometry, const GasState& start)
      : balls_(static_cast<size_t>(geometry.balls())) {
    bodies_.reserve(start.balls.size() + start.pistons.size());
    for (const GasBall& ball : start.balls) bodies_.push_back({.energy = EnergyOf(ball)});
    for (const GasPiston& piston : start.pistons) bodies_.push_back({.energy = EnergyOf(piston)});
  }

  // The current is measured from time 0 on, so the run must not have advanced.
  void MeasureCurrent(std::unique_ptr<CurrentMeter> current) { current_ = std::move(current); }
  const CurrentMeter* current() const { return current_.get(); }  // or null

  // Discards all earlier measurements except the current.
  void Begin(double time) {
    begin_ = time;
    exchanges_ = 0;
    carried_ = 0;
    for (Body& body : bodies_) body = {.energy = body.energy, .since = time};
  }

  void See(const GasEvent& event) {
    if (event.kind == EventKind::kBallPiston) Exchange(event);
    if (event.kind == EventKind::kPistonWall) {
      SetPiston(event.time, event.piston, event.piston_energy);
    }
    if (event.kind == EventKind::kEscape) CountEscape();
  }

  void Exchange(const GasEvent& exchange) {
    ++exchanges_;
    Body& ball = bodies_[static_cast<size_t>(exchange.ball)];
    const double carried = IsAlongX(exchange.direction)
                               ? SignOf(exchange.direction) * (ball.energy - exchange.ball_energy)
                               : 0;
    carried_ += carried;
    if (current_ != nullptr) current_->Exchange(exchange, carried);
    Set(exchange.time, exchange.ball_energy, ball);
    SetPiston(exchange.time, exchange.piston, exchange.piston_energy);
  }

  // A piston has this energy from `time` on.
  void SetPiston(double time, int64_t piston, double energy) {
    Set(time, energy, bodies_[balls_ + static_cast<size_t>(piston)]);
  }

  // A ball has left its cell, which is a defect.
  void CountEscape() { ++escapes_; }

  void End(double time) {
    if (current_ != nullptr) current_->End(time);
    end_ = time;
    for (Body& body : bodies_) Set(time, body.energy, body);
  }

  uint64_t escapes() const { return escapes_; }  // since the start
  uint64_t exchanges() const { return exchanges_; }
  // The energy carried through all contacts along x, toward +x.
  double carried() const { return carried_; }
  double duration() const { return end_ - begin_; }

  size_t balls() const { return balls_; }
  size_t bodies() const { return bodies_.size(); }
  double MeanEnergy(size_t body) const { return bodies_[body].integral / duration(); }
  double Energy(size_t body) const { return bodies_[body].energy; }
  double TotalEnergy() const {
    double sum = 0;
    for (const Body& body : bodies_) sum += body.energy;
    return sum;
  }

 private:
  struct Body {
    double energy = 0;
    double since = 0;     // the time from which the body has this energy
    double integral = 0;  // of its energy up to that time
  };

  static void Set(double time, double energy, Body& body) {
    body.integral += body.energy * (time - body.since);
    body.energy = energy;
    body.since = time;
  }

  size_t balls_;
  std::vector<Body> bodies_;
  double begin_ = 0;
  double end_ = 0;
  uint64_t escapes_ = 0;
  uint64_t exchanges_ = 0;
  double carried_ = 0;
  std::unique_ptr<CurrentMeter> current_;
};

}  // namespace ballpiston
