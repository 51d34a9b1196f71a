// Runs a test under every instruction set that this machine and the build support.
#pragma once

#include <hwy/targets.h>

#include "tests/support/preamble.h"

namespace ballpiston {

inline bool HasFusedMultiplyAdd(int64_t target) {
#if HWY_ARCH_X86
  return target <= HWY_AVX2;  // better ones have smaller values
#else
  return target != HWY_SCALAR && target != HWY_EMU128;
#endif
}

// Whether the lanes use fused multiply-add by default.
inline bool LanesAreFused() {
  return HasFusedMultiplyAdd(hwy::SupportedAndGeneratedTargets().front());  // the best
}

inline void ForEachTarget(const std::function<void(int64_t target)>& test) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    test(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

// Runs a test under the targets with fused multiply-add. All of these must give the same bits.
inline void ForEachFusedTarget(const std::function<void()>& test) {
  int targets = 0;
  ForEachTarget([&](int64_t target) {
    if (!HasFusedMultiplyAdd(target)) return;
    ++targets;
    test();
  });
  if (targets == 0) GTEST_SKIP() << "no fused multiply-add here";
}

}  // namespace ballpiston
