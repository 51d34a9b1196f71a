// The memory that a computation takes is at most what was planned
// (core/ensemble/experiment_kind.h).
#pragma once

#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kMemoryCheck[] = "memory";

// Code that runs for the first time, caches of closed forms, and the answer itself, in bytes.
inline constexpr double kMemoryOfAnyAnswer = 3e7;

// The largest memory of this process since the object was made, above that of the beginning, in
// bytes. At most one object at a time.
class PeakMemory {
 public:
  PeakMemory();
  double Bytes() const;

 private:
  double at_first_;
};

// Under a sanitizer, which takes memory of its own, every measured value passes.
Findings CheckMemory(double planned, double measured);

}  // namespace ballpiston::questions
