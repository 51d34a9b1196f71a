// Jumps in vector lanes, from words of random bits; see jump_process.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ballpiston {

// The size of a group of walkers: a whole number of vectors on every processor.
inline constexpr size_t kJumpGroup = 32;

// Words 4 block, ..., 4 block + 3 of the sequences of CounterRandom for samples first, first + 1,
// ...: by word, then by sample.
struct JumpWords {
  uint64_t words[4][kJumpGroup];
};
void DrawJumpWords(uint64_t seed, uint64_t stream, uint64_t first, uint64_t block,
                   JumpWords& drawn);

// Replaces the u of a group by the u after a jump, and writes the waiting times. The uniform
// numbers are those that CounterRandom computes from the words.
void JumpInLanes(const uint64_t* waiting_words, const uint64_t* target_words, double* u,
                 double* waiting_times);

}  // namespace ballpiston
