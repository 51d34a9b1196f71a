// Accuracy. No step cancels: 1 - 2 u^2 is fused, s^2 = (1 - u)(1 + u), and for u' > u, with
// w = c v - u A in [0, q],
//     s^2 - (q - w)^2 = u^2 + w (2 q - w).
// w loses digits if it is much smaller than u A. The loss is at most a rounding of u^2, because
// then u A <= 2 u^2.
#include "core/markov/jump_process.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/markov/jump_process.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cassert>
#include <numbers>
#include <utility>

#include "core/markov/jump_process_functions-inl.h"
#include "core/sampling/counter_random.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kJumpGroup>;
using V = hn::Vec<D>;

// The targets of one vector. One of the two squares is selected before the square root. At u = 0
// the lower square is never selected, and may be a NaN.
HWY_INLINE V Target(V u, V q, V low, V c, V v) {
  const D d;
  const V one = hn::Set(d, 1.0), g = hn::Mul(c, v);
  const V sine = SineOfQuarterTurn(d, hn::Div(g, u));
  const V s_squared = hn::Mul(hn::Sub(one, u), hn::Add(one, u));
  const V below = hn::Mul(s_squared, hn::Mul(sine, sine));
  const V w = hn::MulSub(c, v, low);
  const V above = hn::MulAdd(w, hn::Sub(hn::Add(q, q), w), hn::Mul(u, u));
  return hn::Sqrt(hn::Min(hn::IfThenElse(hn::Lt(g, low), below, above), one));
}

HWY_INLINE void JumpOnce(const uint64_t* waiting_words, const uint64_t* target_words, double* us,
                         double* waiting_times) {
  const D d;
  const V u = hn::LoadU(d, us);
  const V q_squared = hn::NegMulAdd(hn::Add(u, u), u, hn::Set(d, 1.0));
  const V q = hn::Sqrt(hn::Max(q_squared, hn::Zero(d)));
  const V low = hn::Mul(u, AngleOf(d, u, q)), c = hn::Add(q, low);
  hn::StoreU(Target(u, q, low, c, UniformOf(d, target_words)), d, us);
  const V scale = hn::Set(d, std::numbers::sqrt2 * std::numbers::pi);
  const V minus_log = MinusLog(d, UniformOf(d, waiting_words));
  hn::StoreU(hn::Div(hn::Mul(minus_log, scale), c), d, waiting_times);
}

void JumpGroup(const uint64_t* HWY_RESTRICT waiting_words,
               const uint64_t* HWY_RESTRICT target_words, double* HWY_RESTRICT u,
               double* HWY_RESTRICT waiting_times) {
  for (size_t i = 0; i < kJumpGroup; i += hn::Lanes(D())) {
    JumpOnce(waiting_words + i, target_words + i, u + i, waiting_times + i);
  }
}

void DrawGroup(uint64_t seed, uint64_t stream, uint64_t first, uint64_t block, JumpWords& drawn) {
  for (size_t i = 0; i < kJumpGroup; ++i) {
    uint64_t words[CounterRandom::kBlock];
    CounterRandom(seed, stream, first + i, 0, block).DrawBlock(words);
    for (size_t word = 0; word < CounterRandom::kBlock; ++word) drawn.words[word][i] = words[word];
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(JumpGroup);
HWY_EXPORT(DrawGroup);

void JumpInLanes(const uint64_t* waiting_words, const uint64_t* target_words, double* u,
                 double* waiting_times) {
  HWY_DYNAMIC_DISPATCH(JumpGroup)(waiting_words, target_words, u, waiting_times);
}

JumpWalkers::JumpWalkers(uint64_t seed, uint64_t stream, uint64_t first, std::vector<double> u)
    : seed_(seed), stream_(stream), first_(first), walkers_(u.size()), u_(std::move(u)) {
  assert(std::all_of(u_.begin(), u_.end(), [](double x) { return x >= 0 && x <= 1; }));
  words_.resize((walkers_ + kJumpGroup - 1) / kJumpGroup);
  u_.resize(words_.size() * kJumpGroup);
  times_.resize(u_.size());
}

// Philox makes the words of two jumps at once.
void JumpWalkers::Jump() {
  const uint64_t block = 1 + jumps_ / 2, used = jumps_ % 2 * 2;
  for (size_t group = 0; group < words_.size(); ++group) {
    const size_t begin = group * kJumpGroup;
    auto& [words] = words_[group];
    if (used == 0) {
      HWY_DYNAMIC_DISPATCH(DrawGroup)(seed_, stream_, first_ + begin, block, words_[group]);
    }
    JumpInLanes(words[used], words[used + 1], u_.data() + begin, times_.data() + begin);
  }
  ++jumps_;
}

}  // namespace ballpiston
#endif  // HWY_ONCE
