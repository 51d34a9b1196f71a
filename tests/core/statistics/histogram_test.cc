#include "core/statistics/histogram.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Values at or beyond an end are counted in its bin.
TEST(Histogram, CountsInTheBinThatHoldsTheValue) {
  Histogram inside = Histogram::OfBins(-1, 1, 4), beyond = inside;
  for (const double x : {-1.0, -0.51, -0.5, -0.01, 0.0, 0.49, 0.5, 0.99}) inside.Add(x);
  EXPECT_EQ(inside.counts, (std::vector<uint64_t>{2, 2, 2, 2}));
  for (const double x : {1.0, std::nextafter(1.0, 2.0), std::nextafter(-1.0, -2.0)}) beyond.Add(x);
  EXPECT_EQ(beyond.counts, (std::vector<uint64_t>{1, 0, 0, 2}));
  beyond.Merge(inside);
  EXPECT_EQ(beyond.counts, (std::vector<uint64_t>{3, 2, 2, 4}));
  EXPECT_EQ(beyond.Total(), 11u);
}

}  // namespace
}  // namespace ballpiston
