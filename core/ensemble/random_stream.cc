#include "core/ensemble/random_stream.h"

#include <bit>

#include "core/ensemble/experiment_kind.h"

namespace ballpiston {
namespace {

// The finaliser of SplitMix64: every bit of the input reaches every bit of the output.
uint64_t Mix(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

uint64_t Absorb(uint64_t hash, uint64_t word) { return Mix(hash + 0x9e3779b97f4a7c15 + word); }

// Both billiard models use the same random numbers, so that their results can be compared by eye.
// The jump process has its own random numbers, because statistics compare it with the billiard.
enum class Stream : uint64_t { kBilliard, kJumpProcess };

Stream StreamOf(const EnsembleSpec& spec) {
  return spec.model == Model::kMarkov ? Stream::kJumpProcess : Stream::kBilliard;
}

}  // namespace

uint64_t PointStream(const EnsembleSpec& spec, const PointParameters& parameters) {
  uint64_t hash = Absorb(static_cast<uint64_t>(StreamOf(spec)), spec.experiment->number);
  for (const Parameter* parameter : kParameters) {
    const auto& value = parameters.Find(*parameter);
    if (!value) continue;
    hash = Absorb(hash, parameter->index);
    hash = Absorb(hash, std::bit_cast<uint64_t>(*value + 0.0));  // +0 makes one of the two zeros
  }
  return hash;
}

}  // namespace ballpiston
