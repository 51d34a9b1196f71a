#include "tests/questions/checks.h"
#include "tests/support/process.h"

namespace ballpiston::questions {
namespace {

#ifdef BALLPISTON_SANITIZED
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

double BytesOf(const std::string& line) { return 1024 * 1024 * MiBOf("self", line); }

}  // namespace

PeakMemory::PeakMemory() : at_first_(BytesOf("VmRSS:")) {
  std::ofstream("/proc/self/clear_refs") << "5";  // forgets the largest value
}

double PeakMemory::Bytes() const { return BytesOf("VmHWM:") - at_first_; }

Findings CheckMemory(double planned, double measured) {
  if (kIsSanitized || measured <= planned + kMemoryOfAnyAnswer) return {};
  return {{kMemoryCheck,
           absl::StrFormat("planned %.0f MB, took %.0f MB", 1e-6 * planned, 1e-6 * measured)}};
}

}  // namespace ballpiston::questions
