#include "core/ensemble/block_result.h"

#include <algorithm>
#include <bit>
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

// A step is a bijection of the state for each word, and of the word for each state: multiplication
// by an odd number, and the upper half mixed into the lower one.
class Digest {
 public:
  void Add(uint64_t word) {
    state_ = (state_ ^ word) * 0x9e3779b97f4a7c15;
    state_ ^= state_ >> 32;
  }
  void Add(double number) { Add(std::bit_cast<uint64_t>(number)); }
  template <typename... Numbers>
  void AddAll(Numbers... numbers) {
    (Add(numbers), ...);
  }
  uint64_t state() const { return state_; }

 private:
  uint64_t state_ = 0x2545f4914f6cdd1d;
};

void Add(const Moments& m, Digest& digest) { digest.AddAll(m.count, m.mean, m.m2, m.m3, m.m4); }

void Add(const BatchMeans& b, Digest& digest) {
  digest.AddAll(b.batches, b.mean_numerator, b.mean_denominator, b.c_nn, b.c_nd, b.c_dd);
}

void Add(const Histogram& histogram, Digest& digest) {
  digest.AddAll(histogram.lower, histogram.upper, uint64_t{histogram.counts.size()});
  for (const uint64_t count : histogram.counts) digest.Add(count);
}

void Add(const GroupState& group, Digest& digest) {
  digest.Add(uint64_t{group.numbers().size()});
  for (const double number : group.numbers()) digest.Add(number);
}

// The number of parts first, so that none can be taken for a part of another kind.
template <typename Part>
void Add(const std::vector<Part>& parts, Digest& digest) {
  digest.Add(uint64_t{parts.size()});
  for (const Part& part : parts) Add(part, digest);
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

uint64_t DigestOf(const BlockResult& result) {
  Digest digest;
  digest.Add(result.samples);
  Add(result.moments, digest);
  Add(result.batch_means, digest);
  Add(result.histograms, digest);
  digest.AddAll(result.health.escapes, result.health.max_energy_error);
  Add(result.groups, digest);
  return digest.state();
}

}  // namespace ballpiston
