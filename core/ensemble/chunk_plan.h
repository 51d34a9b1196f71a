// A plan divides a point's samples into chunks, and a chunk into blocks.
//
// Workers compute blocks, and the fold merges blocks. A block takes at most about 0.05 s, or has
// one sample. A chunk has about 32 blocks or more; a tolerance is judged at the end of a chunk.
// Chunk k has base 2^k samples, up to a maximum that takes about a minute at nominal speed. base
// takes a few milliseconds or is 64 samples, whichever is more. So a computation of 10 ms ends
// after about 10 ms, and the tolerance of a computation of hours is judged at most a few hundred
// times. A computation that ends when its error is small enough tends to state too small an error.
// With many samples the bias is small, because their number about doubles from one judgement to the
// next. With few trajectories the first judgement is later (PointExperiment::ReachesTolerance).
//
// If 64 samples take more than a minute, all chunks have fewer samples: as many as take a minute,
// or one. A tolerance is then judged after each 64 samples.
//
// Where samples continue each other, a sample is a stretch of a trajectory. The trajectories of a
// point form groups, and chunk c is one block: the next stretches of all trajectories of group c %
// groups. It starts from the state in which chunk c - groups, of the same group, has ended. So the
// groups can be computed at the same time. One chunk of each group makes a stage, and a tolerance
// is judged after each stage. The first stage has the warm-up and one more stretch of each
// trajectory. After stage s each trajectory has 2^s stretches after its warm-up, until a chunk
// takes about a minute. If the warm-up alone takes longer, all stages are equally long.
//
// All sizes are powers of two, so a rounding difference in the predicted cost of a sample changes
// the plan only if that cost lies next to a power of two. The sizes depend only on the engine and
// on that prediction, never on threads or machines.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/billiard/orbits.h"
#include "core/ensemble/block_result.h"

namespace ballpiston {

// Samples first ... first + samples - 1 of a point; the index-th block of its chunk.
struct Block {
  uint64_t chunk = 0;
  uint64_t index = 0;
  uint64_t first = 0;
  uint64_t samples = 0;
  GroupState start = {};  // if samples continue each other; empty in the first stage

  friend bool operator==(const Block&, const Block&) = default;
};

// The trajectories of a point whose samples continue each other; powers of two.
struct Trajectories {
  uint64_t groups = 16;  // enough for an error between groups, and for as many threads
  uint64_t each = 1;     // trajectories of a group
  uint64_t warm_up = 1;  // stretches of each trajectory that are not measured

  uint64_t count() const { return groups * each; }
};

class ChunkPlan {
 public:
  ChunkPlan() = default;  // for an answer that needs no samples
  // events_per_sample > 0, in wall hits. Blocks hold `together` samples or more, a power of two:
  // the samples of one orbit.
  ChunkPlan(uint64_t samples, Engine engine, double events_per_sample, uint64_t together = 1);
  // Samples that continue each other: those of the warm-up, and at least `samples` more.
  ChunkPlan(uint64_t samples, Engine engine, double events_per_sample,
            const Trajectories& trajectories);

  uint64_t samples() const { return samples_; }  // in total; a maximum for an open-ended target
  double events_per_sample() const { return events_per_sample_; }

  // Of samples that continue each other; 0 if samples are independent.
  uint64_t groups() const { return trajectories_.groups; }
  // A step is a sample, or a stretch of each trajectory.
  uint64_t SamplesOfAStep() const { return std::max<uint64_t>(trajectories_.count(), 1); }
  uint64_t warm_up() const { return trajectories_.count() * trajectories_.warm_up; }  // in samples

  uint64_t chunks() const { return StagesWith(steps_) * ChunksOfAStage(); }
  uint64_t FirstSample(uint64_t chunk) const;
  uint64_t SamplesIn(uint64_t chunk) const;  // chunk < chunks()
  uint64_t BlocksIn(uint64_t chunk) const;
  Block BlockAt(uint64_t chunk, uint64_t index) const;
  uint64_t MostInABlock() const { return std::max(largest_block_, smallest_block_); }

  // Whether a tolerance is judged when this chunk and all before it are merged.
  bool IsJudgedAfter(uint64_t chunk) const;

  // The expected time on one core at nominal speed.
  double SecondsFor(double samples) const {
    return samples * events_per_sample_ * seconds_per_event_;
  }

  // The fewest chunks with at least `samples` samples after the warm-up, after which a tolerance is
  // judged; all if there are fewer samples.
  uint64_t ChunksFor(double samples) const;
  uint64_t SamplesBefore(uint64_t chunk) const;  // chunk <= chunks()

  // The first chunk that has fewer samples than it would have in a plan with more samples; chunks()
  // if there is none.
  uint64_t FirstCutChunk() const;

 private:
  // A stage is a chunk, or the chunks of all groups.
  uint64_t ChunksOfAStage() const { return std::max<uint64_t>(groups(), 1); }
  uint64_t StepsBefore(uint64_t stage) const;
  uint64_t StepsIn(uint64_t stage) const;     // of the planned ones
  uint64_t StagesWith(uint64_t steps) const;  // the fewest that have so many steps
  uint64_t BlockSize(uint64_t chunk) const;

  Trajectories trajectories_ = {.groups = 0, .each = 0, .warm_up = 0};
  uint64_t samples_ = 0;
  uint64_t steps_ = 0;
  double events_per_sample_ = 1;
  double seconds_per_event_ = 0;
  uint64_t base_ = 1;       // steps of the first stage of independent samples
  uint64_t doublings_ = 0;  // the number of stages before all have the largest size
  uint64_t largest_ = 1;    // steps of a stage
  uint64_t smallest_block_ = 1;
  uint64_t largest_block_ = 1;
};

}  // namespace ballpiston
