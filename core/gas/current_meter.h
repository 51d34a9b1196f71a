// The heat current of a periodic gas along x, and the conductivity from it by Green and Kubo's
// formula.
//
// The current is measured in equilibrium, integrated over equal time steps. Its autocorrelation
// C(t) per cell gives the conductivity,
//
//   kappa T^2 = integral over t > 0 of C(t),
//
// cut off at a window: C counts fully up to the window, and its weight falls to 0 over one more
// step. A replica gives one value of each quantity below. The values have no bias except that of
// the window. The scatter grows as the root of the window.
//
// Properties, each with the test that bears its name:
//   1. StepsHoldTheWholeCurrent.  2. CountsProductsOfDifferentExchanges.
#pragma once

#include <cstddef>
#include <vector>

namespace ballpiston {

struct GasEvent;

// The integral of a current over each of several equal steps of time from 0.
class CurrentSteps {
 public:
  CurrentSteps(double duration, size_t count)
      : steps_(count), per_time_(static_cast<double>(count) / duration) {}

  void AddAt(double time, double amount) { steps_[StepAt(time)] += amount; }
  // A current that does not change from `begin` to `end`.
  void AddOver(double begin, double end, double current);

  double length() const { return 1 / per_time_; }
  const std::vector<double>& values() const { return steps_; }

 private:
  // Times after the last step count in the last step.
  size_t StepAt(double time) const;

  std::vector<double> steps_;
  double per_time_;
};

// The measurements of one replica at temperature 1. Each list has one value for each lag, which is
// its index in steps.
struct GreenKubo {
  std::vector<double> autocorrelation;  // the mean of C over the steps, without the static part
  std::vector<double> conductivity;     // with a window of this many steps
  double plain = 0;  // the conductivity with the longest window, without a test function
};

inline constexpr size_t kCurrentSteps = 32;  // of a replica
inline constexpr size_t kWindow = 16;        // in steps

class CurrentMeter {
 public:
  virtual ~CurrentMeter() = default;
  // `carried` is the energy that the exchange moved toward +x, from a ball to a piston or back.
  virtual void Exchange(const GasEvent& exchange, double carried) = 0;
  virtual void End(double time) = 0;
  virtual GreenKubo Result() const = 0;
};

// The current is the energy that exchanges carry over half a cell. The mean product of an exchange
// with itself gives the static conductivity, half of the exchange rate. Its exact value replaces
// these products. The result is the static conductivity plus the products of different exchanges.
class CarriedCurrent : public CurrentMeter {
 public:
  // `exchange_rate` is that of the gas at temperature 1.
  CarriedCurrent(size_t cells, double exchange_rate, double duration)
      : cells_(static_cast<double>(cells)),
        exchange_rate_(exchange_rate),
        steps_(duration, kCurrentSteps) {}

  void Exchange(const GasEvent& exchange, double carried) override;
  void End(double) override {}
  GreenKubo Result() const override;

 private:
  double cells_;
  double exchange_rate_;
  CurrentSteps steps_;
  double squares_ = 0;  // the sum of the squares of all exchanges
};

}  // namespace ballpiston
