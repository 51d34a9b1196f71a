// The functions of Highway's library that the core uses, for the statically linked worker. Debian
// has this library as a shared one only.
//
// The declarations are those of Highway 1.0. The instruction sets that a target requires are those
// for which Highway compiles it (hwy/ops/set_macros-inl.h). The C library says which of them the
// processor and the kernel support.
#include <hwy/highway.h>

#include <cstdint>

#if HWY_ARCH_X86
#ifdef __clang__
#define _Bool bool  // the header is for C; GCC knows this name in C++, too
#endif
#include <sys/platform/x86.h>
#endif

namespace hwy {
namespace {

#if HWY_ARCH_X86

bool HasSsse3() { return CPU_FEATURE_ACTIVE(SSSE3); }

bool HasSse4() {
  return HasSsse3() && CPU_FEATURE_ACTIVE(SSE4_1) && CPU_FEATURE_ACTIVE(SSE4_2) &&
         CPU_FEATURE_ACTIVE(PCLMULQDQ) && CPU_FEATURE_ACTIVE(AES);
}

bool HasAvx2() {
  return HasSse4() && CPU_FEATURE_ACTIVE(AVX) && CPU_FEATURE_ACTIVE(AVX2) &&
         CPU_FEATURE_ACTIVE(LZCNT) && CPU_FEATURE_ACTIVE(BMI1) && CPU_FEATURE_ACTIVE(BMI2) &&
         CPU_FEATURE_ACTIVE(FMA) && CPU_FEATURE_ACTIVE(F16C);
}

bool HasAvx3() {
  return HasAvx2() && CPU_FEATURE_ACTIVE(AVX512F) && CPU_FEATURE_ACTIVE(AVX512VL) &&
         CPU_FEATURE_ACTIVE(AVX512CD) && CPU_FEATURE_ACTIVE(AVX512DQ) &&
         CPU_FEATURE_ACTIVE(AVX512BW);
}

// By default Highway is not compiled for its next target, HWY_AVX3_DL.
int64_t Detected() {
  return (HasSsse3() ? HWY_SSSE3 : 0) | (HasSse4() ? HWY_SSE4 : 0) | (HasAvx2() ? HWY_AVX2 : 0) |
         (HasAvx3() ? HWY_AVX3 : 0);
}

#else

int64_t Detected() { return 0; }  // what the compiler may assume, and no more

#endif

}  // namespace

// The target for which everything else is compiled is always supported.
int64_t SupportedTargets() {
  static const int64_t targets = Detected() | HWY_STATIC_TARGET | HWY_EMU128;
  return targets;
}

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy
