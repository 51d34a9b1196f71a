// Requests and checks of runs with fake experiments.
#ifndef BALLPISTON_TESTS_SERVER_RUN_REQUESTS_H_
#define BALLPISTON_TESTS_SERVER_RUN_REQUESTS_H_

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "gtest/gtest.h"
#include "server/scheduling/run.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/scheduling/recording_journal.h"

namespace ballpiston::server {

using JournalPointer = std::shared_ptr<RecordingJournal>;

inline RunRequest RunOf(int64_t key, const EnsembleSpec& spec, const JournalPointer& journal) {
  RunRequest request;
  request.key = key;
  request.spec = spec;
  request.finished.assign(PointCount(spec), false);
  request.has_checkpoints = !journal->stored.empty() || !journal->stored_chunks.empty();
  request.journal = journal;
  return request;
}

// The result of a fake point has the bytes that its blocks give in one place, in order. With a
// tolerance the number of blocks follows from the result.
inline void ExpectPointRight(const EnsembleSpec& spec, size_t point, const BlockResult& merged) {
  const uint64_t computed = merged.samples / kFakeSamplesPerBlock;
  const uint64_t blocks =
      spec.target.samples ? static_cast<uint64_t>(*spec.target.samples) : computed;
  EXPECT_TRUE(merged == FakeMerged(spec, point, blocks)) << "point " << point;
}

inline void ExpectAllPointsRight(const EnsembleSpec& spec, const RecordingJournal& journal) {
  ASSERT_EQ(journal.finished.size(), PointCount(spec));
  for (const auto& [point, merged] : journal.finished) ExpectPointRight(spec, point, merged);
}

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_RUN_REQUESTS_H_
