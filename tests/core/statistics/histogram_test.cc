#include "core/statistics/histogram.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ballpiston {
namespace {

TEST(Histogram, CountsInTheBinThatHoldsTheValue) {
  Histogram histogram = Histogram::OfBins(-1, 1, 4);
  for (const double x : {-1.0, -0.51, -0.5, -0.01, 0.0, 0.49, 0.5, 0.99}) histogram.Add(x);
  EXPECT_EQ(histogram.counts, (std::vector<uint64_t>{2, 2, 2, 2}));
}

TEST(Histogram, SamplesAtOrBeyondTheEndsAreCounted) {
  Histogram histogram = Histogram::OfBins(-1, 1, 2);
  histogram.Add(1);
  histogram.Add(std::nextafter(1.0, 2.0));
  histogram.Add(std::nextafter(-1.0, -2.0));
  EXPECT_EQ(histogram.counts, (std::vector<uint64_t>{1, 2}));
  EXPECT_EQ(histogram.Total(), 3u);
}

TEST(Histogram, EdgesRunFromEndToEnd) {
  const Histogram histogram = Histogram::OfBins(-0.3, 0.7, 1000);
  EXPECT_EQ(histogram.Edge(0), -0.3);
  EXPECT_EQ(histogram.Edge(1000), 0.7);
  EXPECT_NEAR(histogram.Edge(300), 0, 1e-16);
}

TEST(Histogram, MergeAddsCounts) {
  Histogram a = Histogram::OfBins(0, 1, 2), b = a;
  a.Add(0.1);
  b.Add(0.2);
  b.Add(0.9);
  a.Merge(b);
  EXPECT_EQ(a.counts, (std::vector<uint64_t>{2, 1}));
}

}  // namespace
}  // namespace ballpiston
