// Converts the core's records of collisions to the messages of TraceService.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "ballpiston/v1/trace.pb.h"
#include "core/ensemble/collision_sampler.h"

namespace ballpiston::server {

inline constexpr size_t kCollisionsOfMessage = 1024;

// Upper bound of the memory, in MiB, of a sampler, its records and a message.
inline constexpr int64_t kMibOfSampler = 48;

// The messages of one request. Not thread-safe.
class CollisionMessages {
 public:
  // INVALID_ARGUMENT with the violations of the specification, or those of a sampler.
  static absl::StatusOr<CollisionMessages> Create(const v1::SampleCollisionsRequest& request);

  // Adds the next collisions to the message, at most kCollisionsOfMessage. A call computes for some
  // 0.05 s at most, and adds none if none is ready then. False after the last collision.
  bool FillNext(v1::SampleCollisionsResponse& message);

 private:
  explicit CollisionMessages(const EnsembleSpec& spec);

  std::unique_ptr<const PointExperiment> experiment_;
  std::unique_ptr<std::chrono::steady_clock::time_point> end_of_turn_;  // the sampler reads it
  std::unique_ptr<CollisionSampler> sampler_;
  std::vector<CollisionRecord> records_;  // of the present block
  size_t next_ = 0;
};

}  // namespace ballpiston::server
