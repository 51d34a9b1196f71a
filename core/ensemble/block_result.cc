#include "core/ensemble/block_result.h"

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

void KeepNewer(const std::vector<GroupState>& from, std::vector<GroupState>* into) {
  into->resize(std::max(into->size(), from.size()));
  for (size_t i = 0; i < from.size(); ++i) {
    if (!from[i].empty()) (*into)[i] = from[i];
  }
}

bool HaveSameBins(const Histogram& a, const Histogram& b) {
  return a.lower == b.lower && a.upper == b.upper && a.counts.size() == b.counts.size();
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
  KeepNewer(other.groups, &groups);
}

bool BlockResult::HasShapeOf(const BlockResult& other) const {
  return moments.size() == other.moments.size() && batch_means.size() == other.batch_means.size() &&
         groups.size() == other.groups.size() &&
         std::equal(histograms.begin(), histograms.end(), other.histograms.begin(),
                    other.histograms.end(), HaveSameBins);
}

}  // namespace ballpiston
