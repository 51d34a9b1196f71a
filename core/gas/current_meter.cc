#include "core/gas/current_meter.h"

#include <algorithm>

#include "core/gas/gas_meter.h"
#include "core/statistics/lag_products.h"

namespace ballpiston {

size_t CurrentSteps::StepAt(double time) const {
  return std::min(static_cast<size_t>(time * per_time_), steps_.size() - 1);
}

void CurrentSteps::AddOver(double begin, double end, double current) {
  const size_t last = StepAt(end);
  for (size_t step = StepAt(begin); step < last; ++step) {
    const double border = static_cast<double>(step + 1) / per_time_;
    steps_[step] += current * (border - begin);
    begin = border;
  }
  steps_[last] += current * (end - begin);
}

void CarriedCurrent::Exchange(const GasEvent& exchange, double carried) {
  const double moment = carried / 2;
  steps_.AddAt(exchange.time, moment);
  squares_ += moment * moment;
}

GreenKubo CarriedCurrent::Result() const {
  GreenKubo result;
  result.autocorrelation = LagProducts(steps_.values(), kWindow);
  result.autocorrelation[0] -= squares_ / static_cast<double>(kCurrentSteps);
  result.conductivity = IntegralsOf(result.autocorrelation);
  const double step = steps_.length();
  for (double& c : result.autocorrelation) c /= cells_ * step * step;
  for (double& k : result.conductivity) k = exchange_rate_ / 2 + k / (cells_ * step);
  result.plain = result.conductivity.back();
  return result;
}

}  // namespace ballpiston
