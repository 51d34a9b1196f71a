// A run of an engine: the orbits of pairs (orbits.h), or the blocks of a point
// (ensemble/block_run.h), from a source that supplies the work.
#pragma once

namespace ballpiston {

class EngineRun {
 public:
  virtual ~EngineRun() = default;
  // Returns true when no work is in progress and the source has no more now. Returns false when the
  // source's Pause is true. May be called again in both cases, from any thread.
  virtual bool Advance() = 0;
};

}  // namespace ballpiston
