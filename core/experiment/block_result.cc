#include "core/experiment/block_result.h"

#include <algorithm>
#include <cstddef>

namespace ballpiston {
namespace {

template <typename Accumulator>
void MergeEach(const std::vector<Accumulator>& from, std::vector<Accumulator>* into) {
  if (into->empty()) {
    *into = from;
    return;
  }
  for (size_t i = 0; i < from.size(); ++i) (*into)[i].Merge(from[i]);
}

}  // namespace

void Health::Merge(const Health& other) {
  escapes += other.escapes;
  max_energy_error = std::max(max_energy_error, other.max_energy_error);
}

void BlockResult::Merge(const BlockResult& other) {
  samples += other.samples;
  MergeEach(other.moments, &moments);
  MergeEach(other.batch_means, &batch_means);
  MergeEach(other.histograms, &histograms);
  health.Merge(other.health);
}

}  // namespace ballpiston
