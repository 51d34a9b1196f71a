#include "core/engine_version.h"

#include <hwy/highway.h>

#include <string>

namespace ballpiston {
namespace {

bool HasFusedMultiplyAdd() {
#if HWY_ARCH_X86
  return (hwy::SupportedTargets() & HWY_AVX2) != 0;
#else
  return true;
#endif
}

}  // namespace

std::string EngineVersion() {
  return std::string(kEngineVersion) + (HasFusedMultiplyAdd() ? "" : "-unfused");
}

}  // namespace ballpiston
