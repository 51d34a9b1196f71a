#include "tests/questions/memory_check.h"

#include <fstream>
#include <string>

#include "absl/strings/str_format.h"

namespace ballpiston::questions {
namespace {

#ifdef BALLPISTON_SANITIZED
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

// VmRSS or VmHWM, its largest value.
double BytesOf(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kib = 0;
    if (word == name && status >> kib) return 1024 * kib;
  }
  return 0;
}

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
