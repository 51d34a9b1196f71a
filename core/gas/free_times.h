// Times since the last event of the same kind with the same bodies.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace ballpiston {

class FreeTimes {
 public:
  // A surface is a kind of event with certain bodies.
  explicit FreeTimes(size_t surfaces) : last_(surfaces, kNever) {}

  // Records an event on the surface now. Returns the time since the previous event on this surface;
  // empty for the first event.
  std::optional<double> Hit(size_t surface, double now) {
    const double last = last_[surface];
    last_[surface] = now;
    if (last == kNever) return std::nullopt;
    return now - last;
  }

 private:
  static constexpr double kNever = -std::numeric_limits<double>::infinity();

  std::vector<double> last_;
};

}  // namespace ballpiston
