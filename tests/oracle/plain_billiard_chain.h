// A chain of billiard cells between two reservoirs, event by event, written plainly and without
// core/.
//
// Cell i is centred at (i, 0); its walls are four discs of radius rho at (i +- 1/2, +- 1/2). Ball i
// stays between them. Piston i moves along x around the edge at i - 1/2, at most
// reach = lambda/2 + delta away from it, and is reflected there; so ball i lies between the pistons
// i and i + 1. A ball and a piston in contact exchange their velocities along x. Masses are 1. The
// first piston leaves its left end, and the last one its right end, with a speed of the flux law of
// the reservoir there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace ballpiston {

class PlainBilliardChain {
 public:
  // 1/2 < rho < 1/sqrt(2); 0 < delta; hot > 0 at the left, cold > 0 at the right.
  PlainBilliardChain(size_t cells, double rho, double delta, double hot, double cold, unsigned seed)
      : rho_(rho),
        reach_(std::sqrt(4 * rho * rho - 1) / 2 + delta),
        hot_(hot),
        cold_(cold),
        random_(seed) {
    std::normal_distribution<> normal(0, std::sqrt((hot + cold) / 2));
    for (size_t i = 0; i < cells; ++i) balls_.push_back({0, 0, normal(random_), normal(random_)});
    for (size_t i = 0; i <= cells; ++i) pistons_.push_back({0, normal(random_)});
    Forget();
  }

  // Continues for `duration`.
  void Run(double duration) {
    for (double left = duration; left > 0;) {
      const Event event = NextEvent();
      const double wait = std::min(left, event.wait);
      Advance(wait);
      left -= wait;
      if (left > 0) Meet(event);
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
  double ball_temperature(size_t ball) const { return ball_energy_time_[ball] / time_; }
  double piston_temperature(size_t piston) const { return 2 * piston_energy_time_[piston] / time_; }

 private:
  struct Ball {
    double x, y;  // from the centre of its cell
    double vx, vy;
  };
  struct Piston {
    double x;  // from its edge
    double v;
  };
  enum class Kind { kDisc, kLeftPiston, kRightPiston, kEnd };
  struct Event {
    double wait = std::numeric_limits<double>::infinity();
    Kind kind = Kind::kEnd;
    size_t body = 0;  // a ball, or at an end a piston
    double disc_x = 0, disc_y = 0;
  };

  // The time until the ball touches the disc at (x, y) from outside; infinite if it does not.
  double TimeToDisc(const Ball& ball, double x, double y) const {
    const double dx = ball.x - x, dy = ball.y - y;
    const double a = ball.vx * ball.vx + ball.vy * ball.vy, b = dx * ball.vx + dy * ball.vy;
    const double c = dx * dx + dy * dy - rho_ * rho_;
    const double discriminant = b * b - a * c;
    if (b >= 0 || discriminant <= 0) return std::numeric_limits<double>::infinity();
    return std::fmax(c / (-b + std::sqrt(discriminant)), 0);
  }

  // The time until a gap closes that changes at this speed.
  static double TimeToClose(double gap, double speed) {
    if (speed >= 0) return std::numeric_limits<double>::infinity();
    return std::fmax(gap, 0) / -speed;
  }

  Event NextEvent() const {
    Event next;
    const auto consider = [&next](const Event& event) {
      if (event.wait < next.wait) next = event;
    };
    for (size_t i = 0; i < balls_.size(); ++i) {
      const Ball& ball = balls_[i];
      const Piston &left = pistons_[i], &right = pistons_[i + 1];
      for (const double x : {-0.5, 0.5}) {
        for (const double y : {-0.5, 0.5}) {
          consider({TimeToDisc(ball, x, y), Kind::kDisc, i, x, y});
        }
      }
      consider({TimeToClose(ball.x - (left.x - 0.5), ball.vx - left.v), Kind::kLeftPiston, i});
      consider({TimeToClose(right.x + 0.5 - ball.x, right.v - ball.vx), Kind::kRightPiston, i});
    }
    for (size_t i = 0; i < pistons_.size(); ++i) {
      const Piston& piston = pistons_[i];
      const double gap = piston.v > 0 ? reach_ - piston.x : reach_ + piston.x;
      consider({TimeToClose(gap, -std::fabs(piston.v)), Kind::kEnd, i});
    }
    return next;
  }

  void Advance(double wait) {
    time_ += wait;
    for (size_t i = 0; i < balls_.size(); ++i) {
      Ball& ball = balls_[i];
      ball.x += ball.vx * wait;
      ball.y += ball.vy * wait;
      ball_energy_time_[i] += wait * (ball.vx * ball.vx + ball.vy * ball.vy) / 2;
    }
    for (size_t i = 0; i < pistons_.size(); ++i) {
      pistons_[i].x += pistons_[i].v * wait;
      piston_energy_time_[i] += wait * pistons_[i].v * pistons_[i].v / 2;
    }
  }

  void Meet(const Event& event) {
    switch (event.kind) {
      case Kind::kDisc:
        return Reflect(balls_[event.body], event.disc_x, event.disc_y);
      case Kind::kLeftPiston:
        return Exchange(balls_[event.body], pistons_[event.body], 1);
      case Kind::kRightPiston:
        return Exchange(balls_[event.body], pistons_[event.body + 1], -1);
      case Kind::kEnd:
        return Turn(event.body);
    }
  }

  void Reflect(Ball& ball, double x, double y) const {
    const double nx = (ball.x - x) / rho_, ny = (ball.y - y) / rho_;
    const double normal = (ball.vx * nx + ball.vy * ny) / (nx * nx + ny * ny);
    ball.vx -= 2 * normal * nx;
    ball.vy -= 2 * normal * ny;
  }

  // `sign`: +1 if energy that the ball gains passes toward the cold end.
  void Exchange(Ball& ball, Piston& piston, double sign) {
    const double gain = (piston.v * piston.v - ball.vx * ball.vx) / 2;  // of the ball
    ++exchanges_;
    charge_ += sign * gain / static_cast<double>(2 * balls_.size());
    std::swap(ball.vx, piston.v);
  }

  void Turn(size_t i) {
    Piston& piston = pistons_[i];
    const bool is_at_hot = i == 0 && piston.v < 0;
    const bool is_at_cold = i + 1 == pistons_.size() && piston.v > 0;
    if (!is_at_hot && !is_at_cold) {
      piston.v = -piston.v;
      return;
    }
    const double speed =
        std::sqrt(2 * (is_at_hot ? hot_ : cold_) * std::exponential_distribution<>()(random_));
    piston.v = is_at_hot ? speed : -speed;
  }

  double rho_, reach_, hot_, cold_;
  std::mt19937_64 random_;
  std::vector<Ball> balls_;
  std::vector<Piston> pistons_;
  double time_ = 0, exchanges_ = 0, charge_ = 0;
  std::vector<double> ball_energy_time_, piston_energy_time_;
};

}  // namespace ballpiston
