#include "core/gas/jump_draws.h"

#include <bit>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/gas/jump_draws.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "core/markov/jump_process_functions-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballpiston {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kJumpDraws>;
using V = hn::Vec<D>;

// Draws from a copy, which stays in registers. This saves a fifth of the time.
HWY_INLINE void DrawWords(CounterRandom& random, uint64_t* words) {
  CounterRandom copy = random;
  for (size_t i = 0; i < kJumpDraws; i += CounterRandom::kBlock) copy.DrawBlock(words + i);
  random = copy;
}

struct Kinds {
  explicit Kinds(const JumpKinds& kinds) : kinds(kinds) {}

  // The second kind's number in lanes where `is_second`, else the first kind's.
  HWY_INLINE V Of(hn::Mask<D> is_second, double JumpBodies::*number) const {
    const D d;
    return hn::IfThenElse(is_second, hn::Set(d, kinds[1].*number), hn::Set(d, kinds[0].*number));
  }

  const JumpKinds& kinds;
};

HWY_INLINE void FindAttempt(const Kinds& kinds, size_t i, JumpAttempts& attempts) {
  const D d;
  const hn::Rebind<int32_t, D> indices;
  const V place = UniformOf(d, attempts.words + i);
  const auto second = hn::Ge(place, hn::Set(d, kinds.kinds[1].before));
  const V index = hn::Mul(hn::Sub(place, kinds.Of(second, &JumpBodies::before)),
                          kinds.Of(second, &JumpBodies::per_place));
  const V last = hn::Sub(kinds.Of(second, &JumpBodies::count), hn::Set(d, 1.0));
  const V whole = hn::Min(hn::Floor(index), last);
  const V least = hn::Mul(hn::Sub(index, whole), kinds.Of(second, &JumpBodies::largest));
  hn::StoreU(least, d, attempts.least_speeds + i);
  const V body = hn::Add(kinds.Of(second, &JumpBodies::first), whole);
  hn::StoreU(hn::DemoteTo(indices, body), indices, attempts.bodies + i);
}

void FindAttempts(const JumpKinds& kinds, JumpAttempts& attempts) {
  for (size_t i = 0; i < kJumpDraws; i += hn::Lanes(D())) FindAttempt(Kinds(kinds), i, attempts);
}

void DrawAttempts(const JumpKinds& kinds, CounterRandom& random, JumpAttempts& attempts) {
  DrawWords(random, attempts.words);
  FindAttempts(kinds, attempts);
}

// With the weight of the cosine, the sine is uniform.
HWY_INLINE V CosineOfSine(V sine) {
  const V one = hn::Set(D(), 1.0);
  return hn::Sqrt(hn::Mul(hn::Sub(one, sine), hn::Add(one, sine)));
}

// cos(pi turn) = sin(pi (1/2 - turn)), for turn in [0, 1].
HWY_INLINE V CosineOfHalfTurn(V turn) {
  const D d;
  const V angle = hn::Mul(hn::Sub(hn::Set(d, 0.5), turn), hn::Set(d, std::numbers::pi));
  return SineOfQuarterTurn(d, angle);
}

// Angle and waiting time share a word: each has half of it to itself, and the other's half as
// further bits.
void DrawProposals(CounterRandom& random, JumpProposals& proposals) {
  const D d;
  uint64_t words[kJumpDraws], turned[kJumpDraws];
  DrawWords(random, words);
  for (size_t i = 0; i < kJumpDraws; ++i) turned[i] = std::rotl(words[i], 32);
  for (size_t i = 0; i < kJumpDraws; i += hn::Lanes(d)) {
    const V angle = UniformOf(d, words + i);
    hn::StoreU(CosineOfSine(angle), d, proposals.cosines[0] + i);
    hn::StoreU(CosineOfHalfTurn(angle), d, proposals.cosines[1] + i);
    hn::StoreU(MinusLog(d, UniformOf(d, turned + i)), d, proposals.waits + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace ballpiston
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballpiston {

HWY_EXPORT(FindAttempts);
HWY_EXPORT(DrawAttempts);
HWY_EXPORT(DrawProposals);

void FindJumpAttempts(const JumpKinds& kinds, JumpAttempts& attempts) {
  HWY_DYNAMIC_DISPATCH(FindAttempts)(kinds, attempts);
}

void DrawJumpAttempts(const JumpKinds& kinds, CounterRandom& random, JumpAttempts& attempts) {
  HWY_DYNAMIC_DISPATCH(DrawAttempts)(kinds, random, attempts);
}

void DrawJumpProposals(CounterRandom& random, JumpProposals& proposals) {
  HWY_DYNAMIC_DISPATCH(DrawProposals)(random, proposals);
}

}  // namespace ballpiston
#endif  // HWY_ONCE
