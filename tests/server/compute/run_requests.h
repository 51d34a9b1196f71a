// Requests and checks of runs with fake experiments.
#pragma once

#include "server/compute/run.h"
#include "tests/server/compute/recording_journal.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {

using JournalPointer = std::shared_ptr<RecordingJournal>;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Points of chunks 0 ... 5: 64, 128, 256, 512, 1024 and 1016 samples. One core takes 1.3 s, 2.7 s,
// 5.4 s, 10.7 s, 21.5 s and 21.3 s for them, so one point is just enough for an executor elsewhere.
inline constexpr uint64_t kChunks = 6;
inline EnsembleSpec SixChunks(int points = 1) {
  EnsembleSpec spec = FakeSpec(points, 1500);
  spec.model = Model::kBilliard;  // with a closed form a lease would open 128 points
  return spec;
}

inline RunRequest RunOf(int64_t key, const EnsembleSpec& spec, const JournalPointer& journal) {
  RunRequest request;
  request.key = key;
  request.spec = spec;
  request.finished.assign(PointCount(spec), false);
  request.has_checkpoints = !journal->stored.empty() || !journal->stored_chunks.empty();
  request.journal = journal;
  return request;
}

// The bytes that a fake point has if it is computed in one place.
inline BlockResult ComputedInOnePlace(const EnsembleSpec& spec, size_t point) {
  if (!spec.target.samples) return *FoldPoint(*FakeExperiments()(spec, point));
  return FakeMerged(spec, point, static_cast<uint64_t>(*spec.target.samples));
}

inline void ExpectAllPointsRight(const EnsembleSpec& spec, const RecordingJournal& journal) {
  ASSERT_EQ(journal.finished.size(), PointCount(spec));
  for (const auto& [point, merged] : journal.finished) {
    EXPECT_TRUE(merged == ComputedInOnePlace(spec, point)) << "point " << point;
  }
}

}  // namespace ballpiston::server
