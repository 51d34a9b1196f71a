// Measures a gas in a time window: the number of exchanges, the energy that is carried along x, and
// each body's mean energy. The engine reports every exchange to the meter, in the order of time.
// The meter forwards exchanges to a meter of the current, if it has one.
//
// Bodies are the balls, then the pistons. Placing, beginning and ending take a time in proportion
// to their number; a function that returns false at a pause must be called again. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/gas/current_meter.h"
#include "core/gas/gas_geometry.h"
#include "core/gas/gas_state.h"
#include "core/gas/pauses.h"

namespace ballpiston {

// An exchange of a ball with the piston that it sees in `direction`, and the energies after it.
struct GasExchange {
  double time = 0;
  int64_t ball = 0;
  int64_t piston = 0;
  Direction direction = Direction::kRight;
  double ball_energy = 0;
  double piston_energy = 0;
};

class GasMeter {
 public:
  explicit GasMeter(const GasGeometry& geometry) : balls_(static_cast<size_t>(geometry.balls())) {
    bodies_.reserve(static_cast<size_t>(geometry.balls() + geometry.pistons()));
  }
  GasMeter(const GasGeometry& geometry, const GasState& start) : GasMeter(geometry) {
    Place(start, NoPauses());
  }

  bool Place(const GasState& start, Pauses& pauses) {
    return ForEachBody(start.balls.size() + start.pistons.size(), pauses, [&](size_t i) {
      bodies_.push_back(
          {.energy = i < balls_ ? EnergyOf(start.balls[i]) : EnergyOf(start.pistons[i - balls_])});
    });
  }

  // The current is measured from time 0 on.
  void MeasureCurrent(std::unique_ptr<CurrentMeter> current) { current_ = std::move(current); }
  const CurrentMeter* current() const { return current_.get(); }  // or null

  // Discards all earlier measurements except the current.
  bool Begin(double time, Pauses& pauses = NoPauses()) {
    begin_ = time;
    exchanges_ = 0;
    carried_ = 0;
    return ForEachBody(bodies_.size(), pauses, [&](size_t i) {
      bodies_[i] = {.energy = bodies_[i].energy, .since = time};
    });
  }

  void Exchange(const GasExchange& exchange) {
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

  // A piston has left a thermal wall.
  void SetPiston(double time, int64_t piston, double energy) {
    Set(time, energy, bodies_[balls_ + static_cast<size_t>(piston)]);
  }

  // A ball has left its cell, which is a defect.
  void CountEscape() { ++escapes_; }

  bool End(double time, Pauses& pauses = NoPauses()) {
    if (next_ == 0 && current_ != nullptr) current_->End(time);
    end_ = time;
    return ForEachBody(bodies_.size(), pauses,
                       [&](size_t i) { Set(time, bodies_[i].energy, bodies_[i]); });
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

  template <typename Step>
  bool ForEachBody(size_t bodies, Pauses& pauses, const Step& step) {
    constexpr double kNanoseconds = 10;
    if (!ForEachWithPauses(next_, bodies, kNanoseconds, pauses, step)) return false;
    next_ = 0;
    return true;
  }

  static void Set(double time, double energy, Body& body) {
    body.integral += body.energy * (time - body.since);
    body.energy = energy;
    body.since = time;
  }

  size_t balls_;
  std::vector<Body> bodies_;
  size_t next_ = 0;  // the body with which a call that paused goes on
  double begin_ = 0;
  double end_ = 0;
  uint64_t escapes_ = 0;
  uint64_t exchanges_ = 0;
  double carried_ = 0;
  std::unique_ptr<CurrentMeter> current_;
};

}  // namespace ballpiston
