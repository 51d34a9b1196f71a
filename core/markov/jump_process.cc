#include "core/markov/jump_process.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace ballpiston {

JumpWalkers::JumpWalkers(uint64_t seed, uint64_t stream, uint64_t first, std::vector<double> u)
    : seed_(seed), stream_(stream), first_(first), walkers_(u.size()), u_(std::move(u)) {
  assert(std::all_of(u_.begin(), u_.end(), [](double x) { return x >= 0 && x <= 1; }));
  words_.resize((walkers_ + kJumpGroup - 1) / kJumpGroup);
  u_.resize(words_.size() * kJumpGroup);
  times_.resize(u_.size());
}

// Philox makes the words of two jumps at once.
void JumpWalkers::Jump() {
  const size_t used = jumps_ % 2 * 2;
  for (size_t group = 0; group < words_.size(); ++group) {
    const size_t begin = group * kJumpGroup;
    auto& [words] = words_[group];
    if (used == 0) DrawJumpWords(seed_, stream_, first_ + begin, 1 + jumps_ / 2, words_[group]);
    JumpInLanes(words[used], words[used + 1], u_.data() + begin, times_.data() + begin);
  }
  ++jumps_;
}

}  // namespace ballpiston
