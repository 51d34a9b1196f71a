// Uniform random numbers as a pure function of (seed, stream, sample, draw).
//
// Counter-based (Philox4x64-10 of Random123): key (seed, stream), counter (sample, draw/4, part). A
// block is the four words of one counter. Philox multiplies 64 by 64 bits, for which there is no
// vector instruction. Made of four products of 32 bits, blocks in vector lanes would take as long
// with AVX-512, and twice as long with AVX2. Code that is compiled for AVX2 has an instruction
// (mulx) that saves a fifth of a block's time, so blocks are always inlined into it. The numbers of
// a sample do not depend on the machine, the time, or earlier computations.
//   seed    the user's seed.
//   stream  separates quantities that must be independent under one seed, e.g. points of a grid.
//   sample  index of the sample within the stream.
//   part    separates the sequences of one sample, if the sample needs several.
// One object is one sequence of draws of a sample. Not thread-safe.
#pragma once

#include <Random123/philox.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace ballpiston {

class CounterRandom {
 public:
  CounterRandom(uint64_t seed, uint64_t stream, uint64_t sample, uint64_t part = 0,
                uint64_t first_block = 0)
      : key_{{seed, stream}}, counter_{{sample, first_block, part, 0}} {}

  static constexpr size_t kBlock = 4;  // words

  uint64_t Bits() {
    if (used_ == kBlock) Refill();
    return block_[used_++];
  }

  // In the open interval (0, 1): the midpoints of 2^52 equal cells, each exact in double.
  double Uniform() { return (static_cast<double>(Bits() >> 12) + 0.5) * 0x1p-52; }

  // Draws kBlock words at once, which is faster. Words that Bits() has drawn but not yet returned
  // are returned by later calls of Bits().
  [[gnu::always_inline]] void DrawBlock(uint64_t* words) {
    const r123::Philox4x64::ctr_type block = NextBlock();
    std::copy(block.begin(), block.end(), words);
  }

 private:
  void Refill() {
    block_ = NextBlock();
    used_ = 0;
  }

  [[gnu::always_inline]] r123::Philox4x64::ctr_type NextBlock() {
    const auto block = r123::Philox4x64()(counter_, key_);
    ++counter_[1];
    return block;
  }

  r123::Philox4x64::key_type key_;
  r123::Philox4x64::ctr_type counter_;
  r123::Philox4x64::ctr_type block_ = {};
  size_t used_ = kBlock;
};

}  // namespace ballpiston
