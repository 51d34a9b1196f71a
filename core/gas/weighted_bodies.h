// Draws one of many bodies with a probability proportional to its weight, in a time that does not
// depend on their number; a weight is changed as fast.
//
// Bodies stand in classes of weights in [2^k, 2^(k+1)). A draw picks a class by the number of its
// bodies times 2^(k+1), a body in it at random, and accepts it with its weight over 2^(k+1). The
// sum of these bounds is exact, whatever the order of changes.
#ifndef BALLPISTON_CORE_GAS_WEIGHTED_BODIES_H_
#define BALLPISTON_CORE_GAS_WEIGHTED_BODIES_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace ballpiston {

class WeightedBodies {
 public:
  // All of weight 0.
  explicit WeightedBodies(size_t bodies) : bodies_(bodies) {
    for (size_t i = 0; i < bodies; ++i) Enter(static_cast<uint32_t>(i), 0);
  }

  // 0 <= weight < 2^(kClasses + kLowest).
  void Set(size_t body, double weight) {
    const int to = ClassOf(weight);
    Body& changed = bodies_[body];
    changed.weight = weight;
    if (to == changed.in_class) return;
    Leave(changed);
    Enter(static_cast<uint32_t>(body), to);
  }

  // The sum of the bodies' bounds.
  double Bound() const {
    double sum = 0;
    for (int k = 0; k < kClasses; ++k) sum += SumOf(k);
    return sum;
  }

  // Of a uniform number below Bound(): a body, or nothing, as often as a body's weight is below its
  // bound.
  std::optional<size_t> At(double place) const {
    int k = kClasses - 1;
    for (; k > 0 && place >= SumOf(k); --k) place -= SumOf(k);
    const double bound = BoundOf(k);
    const auto index = std::min(static_cast<size_t>(place / bound), classes_[k].size() - 1);
    const uint32_t body = classes_[k][index];
    if (place - static_cast<double>(index) * bound >= bodies_[body].weight) return std::nullopt;
    return body;
  }

 private:
  static constexpr int kClasses = 48;
  static constexpr int kLowest = -32;  // all weights below 2^(kLowest + 1) are in class 0

  struct Body {
    double weight = 0;
    int32_t in_class = 0;
    uint32_t place = 0;
  };

  static double BoundOf(int k) {
    return std::bit_cast<double>(uint64_t(k + kLowest + 1 + 1023) << 52);
  }
  static int ClassOf(double weight) {
    const int exponent = static_cast<int>(std::bit_cast<uint64_t>(weight) >> 52) - 1023;
    return std::clamp(exponent - kLowest, 0, kClasses - 1);
  }
  double SumOf(int k) const { return static_cast<double>(classes_[k].size()) * BoundOf(k); }

  void Enter(uint32_t body, int k) {
    bodies_[body].in_class = k;
    bodies_[body].place = static_cast<uint32_t>(classes_[k].size());
    classes_[k].push_back(body);
  }
  void Leave(const Body& body) {
    std::vector<uint32_t>& members = classes_[body.in_class];
    members[body.place] = members.back();
    bodies_[members.back()].place = body.place;
    members.pop_back();
  }

  std::vector<Body> bodies_;
  std::array<std::vector<uint32_t>, kClasses> classes_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_GAS_WEIGHTED_BODIES_H_
