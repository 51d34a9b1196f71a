#include "core/experiment/point_stream.h"

#include <bit>

namespace ballpiston {
namespace {

// The finaliser of SplitMix64: every bit of the input reaches every bit of the output.
uint64_t Mix(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

uint64_t Absorb(uint64_t hash, uint64_t word) { return Mix(hash + 0x9e3779b97f4a7c15 + word); }

// +0 makes one of the two zeros. An absent parameter differs from every value: NaN is not one.
uint64_t Word(const std::optional<double>& value) {
  return value ? std::bit_cast<uint64_t>(*value + 0.0) : ~uint64_t{0};
}

}  // namespace

uint64_t PointStream(Experiment experiment, const PointParameters& parameters) {
  uint64_t hash = Absorb(0, static_cast<uint64_t>(experiment));
  hash = Absorb(hash, Word(parameters.rho));
  hash = Absorb(hash, Word(parameters.delta));
  hash = Absorb(hash, Word(parameters.epsilon));
  return Absorb(hash, Word(parameters.exponent));
}

}  // namespace ballpiston
