// A chain of cells between two reservoirs as a jump process, written plainly and without core/.
//
// Ball i lies between the pistons i and i + 1. Masses are 1. A ball has the speed b and the mean
// energy T, a piston the speed p and the mean energy T/2. At a contact the ball has v1 = b
// cos(angle) toward the piston, with a uniform angle, and the piston has v3 = +p or -p. They
// exchange v1 and v3 at the rate density (v1 - v3)+; `density` is a number in a unit of length, and
// the rate of a contact in equilibrium is density sqrt(T/pi). Each outermost piston has a new
// Gaussian velocity of its reservoir's temperature at every contact.
//
// The sampling is exact: (v1 - v3)+ is at most b + |v3|, so each contact proposes an exchange at
// the rate density (b + <|v3|>), with v3 drawn with the weight b + |v3|, and accepts it with the
// probability (v1 - v3)+/(b + |v3|).
#pragma once

#include "tests/support/preamble.h"

namespace ballpiston {

class PlainJumpChain {
 public:
  // hot > 0 at the left, cold > 0 at the right.
  PlainJumpChain(size_t cells, double density, double hot, double cold, unsigned seed)
      : density_(density),
        hot_(hot),
        cold_(cold),
        random_(seed),
        balls_(cells, std::sqrt(hot + cold)),
        pistons_(cells + 1, std::sqrt((hot + cold) / 2)) {
    Forget();
  }

  // Continues for `duration`.
  void Run(double duration) {
    std::vector<double> rates(2 * balls_.size());
    for (double left = duration; left > 0;) {
      for (size_t contact = 0; contact < rates.size(); ++contact) rates[contact] = Rate(contact);
      const double total = std::accumulate(rates.begin(), rates.end(), 0.0);
      const double wait = std::min(left, std::exponential_distribution<>(total)(random_));
      Measure(wait);
      left -= wait;
      if (left > 0) Propose(Chosen(rates, total * Uniform()));
    }
  }

  // Begins to measure anew.
  void Forget() {
    time_ = exchanges_ = charge_ = 0;
    ball_energy_time_.assign(balls_.size(), 0);
    piston_energy_time_.assign(pistons_.size(), 0);
  }

  // Since the last Forget: the energy that has passed from hot to cold, the mean over all contacts;
  // exchanges of a contact in a unit of time; temperatures.
  double charge() const { return charge_; }
  double time() const { return time_; }
  double rate() const { return exchanges_ / time_ / static_cast<double>(2 * balls_.size()); }
  // The mean temperature at a place, from 1 (the first ball) to 2 cells - 1 (the last ball). Odd
  // places are balls, even places are pistons.
  double temperature(size_t place) const {
    return (place % 2 == 1 ? ball_energy_time_[place / 2] : 2 * piston_energy_time_[place / 2]) /
           time_;
  }

 private:
  // Contact 2 i is that of ball i with its left piston, contact 2 i + 1 with its right one.
  static size_t Piston(size_t contact) { return (contact + 1) / 2; }
  bool IsOuter(size_t piston) const { return piston == 0 || piston + 1 == pistons_.size(); }
  double Temperature(size_t piston) const { return piston == 0 ? hot_ : cold_; }

  double MeanSpeed(size_t piston) const {
    if (!IsOuter(piston)) return pistons_[piston];
    return std::sqrt(2 * Temperature(piston) / std::numbers::pi);
  }

  double Rate(size_t contact) const {
    return density_ * (balls_[contact / 2] + MeanSpeed(Piston(contact)));
  }

  double Uniform() { return std::uniform_real_distribution<>()(random_); }

  static size_t Chosen(const std::vector<double>& rates, double level) {
    size_t contact = 0;
    while (contact + 1 < rates.size() && level >= rates[contact]) level -= rates[contact++];
    return contact;
  }

  // A speed of an outermost piston with the weight b + |v3|: the normal law, or that law with the
  // weight |v3|.
  double OuterSpeed(size_t piston, double b) {
    const double root = std::sqrt(Temperature(piston));
    if (Uniform() * (b + MeanSpeed(piston)) < b) {
      return std::fabs(root * std::normal_distribution<>()(random_));
    }
    return root * std::sqrt(2 * std::exponential_distribution<>()(random_));
  }

  void Propose(size_t contact) {
    const size_t piston = Piston(contact);
    double& ball = balls_[contact / 2];
    const double speed = IsOuter(piston) ? OuterSpeed(piston, ball) : pistons_[piston];
    const double v1 = ball * std::cos(2 * std::numbers::pi * Uniform());
    const double v3 = Uniform() < 0.5 ? speed : -speed;
    if (Uniform() * (ball + speed) >= v1 - v3) return;
    const double gain = (v3 * v3 - v1 * v1) / 2;  // of the ball
    ++exchanges_;
    charge_ += (contact % 2 == 0 ? gain : -gain) / static_cast<double>(2 * balls_.size());
    ball = std::sqrt(std::fmax(0, ball * ball + 2 * gain));
    pistons_[piston] = std::fabs(v1);
  }

  void Measure(double wait) {
    time_ += wait;
    for (size_t i = 0; i < balls_.size(); ++i) {
      ball_energy_time_[i] += wait * balls_[i] * balls_[i] / 2;
    }
    for (size_t i = 0; i < pistons_.size(); ++i) {
      piston_energy_time_[i] += wait * pistons_[i] * pistons_[i] / 2;
    }
  }

  double density_, hot_, cold_;
  std::mt19937_64 random_;
  std::vector<double> balls_, pistons_;  // speeds; those of the outermost pistons have no meaning
  double time_ = 0, exchanges_ = 0, charge_ = 0;
  std::vector<double> ball_energy_time_, piston_energy_time_;
};

}  // namespace ballpiston
