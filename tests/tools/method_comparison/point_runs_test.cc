#include "tools/method_comparison/point_runs.h"

#include "tests/core/preamble.h"

namespace ballpiston::method_comparison {
namespace {

bool Overlap(const SampleRange& a, const SampleRange& b) {
  return a.first < b.first + b.count && b.first < a.first + a.count;
}

TEST(PointRuns, RunsHaveNoSampleInCommon) {
  std::vector<SampleRange> runs;
  for (uint64_t samples = 64; samples <= uint64_t{1} << 30; samples *= 4) {
    runs.push_back(RunOf(samples));
  }
  for (uint64_t samples = 1; samples <= uint64_t{1} << 32; samples *= 2) {
    EXPECT_EQ(TruthOf(samples).count, samples);
    for (const SampleRange& run : runs) {
      EXPECT_FALSE(Overlap(run, TruthOf(samples))) << run.count << " and " << samples;
    }
  }
  for (size_t i = 1; i < runs.size(); ++i) EXPECT_FALSE(Overlap(runs[i - 1], runs[i])) << i;
}

}  // namespace
}  // namespace ballpiston::method_comparison
