#include "core/conductivity/contact_currents.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/conductivity/contact_currents.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "core/arithmetic/gauss_nodes.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kValues = ContactCurrentsTable::kValues;

// The weighted sum of four nodes of four rows, all values of a node at once.
void Interpolate(const double* first, size_t row_length, const double* row_weights,
                 const double* weights, double* sums) {
  const hn::CappedTag<double, kValues> d;
  for (size_t value = 0; value < kValues; value += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (size_t row = 0; row < 4; ++row) {
      const double* const nodes = first + row * row_length + value;
      auto of_row = hn::Mul(hn::Set(d, weights[0]), hn::LoadU(d, nodes));
      for (size_t k = 1; k < 4; ++k) {
        of_row = hn::MulAdd(hn::Set(d, weights[k]), hn::LoadU(d, nodes + kValues * k), of_row);
      }
      sum = hn::MulAdd(hn::Set(d, row_weights[row]), of_row, sum);
    }
    hn::StoreU(sum, d, sums + value);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {
namespace {

HWY_EXPORT(Interpolate);

using Values = TestFunction::Values;

constexpr double kLargestRoot = 6;  // of the total energy; exceeded once in 10^15 in equilibrium
constexpr size_t kRoots = 97;
constexpr size_t kPlaces = 49;  // on each side of equal speeds

// f over the angles from 0 to that at which the ball's component is `least`, in [0, speed):
// v = speed - (speed - least) z^2 is smooth at both ends.
template <typename F>
void ForEachAngle(double speed, double least, F f) {
  const double range = speed - least;
  ForEachGaussNode<20>(0, 1, [&](double z, double weight) {
    const double v = speed - range * z * z;
    f(v, 2 * weight * std::sqrt(range / (speed + v)));
  });
}

// The changes by an exchange in which the ball's component is v.
class Changes {
 public:
  Changes(const TestFunction& f, double ball_energy, double piston_energy)
      : f_(f),
        total_(ball_energy + piston_energy),
        piston_energy_(piston_energy),
        ball_(f.OfBall(ball_energy)),
        piston_(f.OfPiston(piston_energy)) {}

  void AddTo(ContactCurrents& sum, double v, double weight) const {
    const double piston_energy = v * v / 2;
    const Values of_ball = f_.OfBall(total_ - piston_energy) - ball_;
    const Values of_piston = f_.OfPiston(piston_energy) - piston_;
    sum.energy += weight * (piston_energy - piston_energy_);
    sum.ball += weight * of_ball;
    sum.piston += weight * of_piston;
    for (int r = 0; r < of_ball.size(); ++r) sum.products += weight * of_ball[r] * of_piston[r];
  }

 private:
  const TestFunction& f_;
  double total_;
  double piston_energy_;
  Values ball_;
  Values piston_;
};

// The interpolation of a value between nodes: the first of four nodes, and their weights.
struct Stencil {
  Stencil(double at, size_t count) {
    const auto last = static_cast<double>(count - 1);
    const auto below = static_cast<size_t>(std::min(at, last));
    first = std::clamp<size_t>(below, 1, count - 3) - 1;
    const double t = at - static_cast<double>(first);
    const double inner = (t - 1) * (t - 2), outer = t * (t - 3);
    weights = {-inner * (t - 3) * (1.0 / 6), outer * (t - 2) * 0.5, -outer * (t - 1) * 0.5,
               inner * t * (1.0 / 6)};
  }

  size_t first;
  std::array<double, 4> weights;
};

constexpr double kRootsInOne = static_cast<double>(kRoots - 1) / kLargestRoot;
constexpr double kPlacesInOne = static_cast<double>(kPlaces - 1);

}  // namespace

ContactCurrents ContactCurrentsOf(const TestFunction& f, double ball_energy, double piston_energy) {
  const double s = std::sqrt(2 * ball_energy), w = std::sqrt(2 * piston_energy);
  const Changes changes(f, ball_energy, piston_energy);
  ContactCurrents sum;
  // The mean over a quarter of the circle is equal to that over the whole circle.
  if (s == 0) {
    changes.AddTo(sum, 0, w / 2);
    return sum;
  }
  ForEachAngle(
      s, 0, [&](double v, double weight) { changes.AddTo(sum, v, w / std::numbers::pi * weight); });
  if (s <= w) return sum;
  ForEachAngle(s, w, [&](double v, double weight) {
    changes.AddTo(sum, v, (v - w) / std::numbers::pi * weight);
  });
  return sum;
}

size_t ContactCurrentsTable::NodeAt(bool is_piston_faster, size_t root, size_t place) const {
  return ((is_piston_faster ? kRoots : 0) + root) * kPlaces + place;
}

ContactCurrentsTable::ContactCurrentsTable(const TestFunction& f) : f_(f) {
  nodes_.resize(2 * kRoots * kPlaces);
  for (const bool is_piston_faster : {false, true}) {
    for (size_t root = 1; root < kRoots; ++root) {  // all is 0 at energies 0
      const double sigma = static_cast<double>(root) / kRootsInOne;
      for (size_t place = 0; place < kPlaces; ++place) {
        const double y = static_cast<double>(place) / kPlacesInOne;
        const double half = sigma * sigma / 2, more = half * (1 + y * y), less = half * (1 - y * y);
        const ContactCurrents c =
            is_piston_faster ? ContactCurrentsOf(f, less, more) : ContactCurrentsOf(f, more, less);
        nodes_[NodeAt(is_piston_faster, root, place)] = {c.energy,  c.products,  c.ball[0],
                                                         c.ball[1], c.piston[0], c.piston[1]};
      }
    }
  }
}

const ContactCurrentsTable& ContactCurrentsTable::OfChain() {
  static const auto& table = *new ContactCurrentsTable(kChainTestFunction);  // is never destroyed
  return table;
}

const ContactCurrentsTable& ContactCurrentsTable::OfLattice() {
  static const auto& table = *new ContactCurrentsTable(kLatticeTestFunction);
  return table;
}

ContactCurrents ContactCurrentsTable::At(double ball_energy, double piston_energy) const {
  const double total = ball_energy + piston_energy;
  const double y = std::sqrt(std::fabs(ball_energy - piston_energy) / total);
  const Stencil root(std::sqrt(total) * kRootsInOne, kRoots), place(y * kPlacesInOne, kPlaces);
  const bool is_piston_faster = piston_energy > ball_energy;
  const Node& first = nodes_[NodeAt(is_piston_faster, root.first, place.first)];
  Node sum;
  HWY_DYNAMIC_DISPATCH(Interpolate)
  (first.data(), kPlaces * kValues, root.weights.data(), place.weights.data(), sum.data());
  return {sum[0], sum[1], {sum[2], sum[3]}, {sum[4], sum[5]}};
}

}  // namespace ballpiston
#endif  // HWY_ONCE
