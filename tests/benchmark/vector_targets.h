// The vector instructions of this machine, for benchmarks that compare them.
#pragma once

#include <hwy/highway.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace ballpiston {

// From SSE4 on, the widest last.
inline std::vector<int64_t> VectorTargets() {
  std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  std::erase_if(targets, [](int64_t target) { return target > HWY_SSE4; });
  std::reverse(targets.begin(), targets.end());
  return targets;
}

// The lanes that begin from now on use these instructions.
inline void Use(int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace ballpiston
