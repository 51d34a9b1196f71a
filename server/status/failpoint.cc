#include "server/status/failpoint.h"

#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "absl/strings/numbers.h"

namespace ballpiston::server::failpoint_internal {
namespace {

constexpr std::string_view kReady = "ready+";

struct Armed {
  std::string_view name;
  bool when_ready = false;
  int64_t number = 0;
};

[[noreturn]] void Refuse(const char* text) {
  std::fprintf(stderr,
               "BALLPISTON_FAILPOINT=%s is not NAME:N or NAME:ready+N with a failpoint's name and "
               "N >= 1\n",
               text);
  std::_Exit(2);
}

bool IsKnown(std::string_view name) {
  return name == kCrashForSeed ||
         std::find(kFailpoints.begin(), kFailpoints.end(), name) != kFailpoints.end();
}

// `text` points into the environment, which nobody changes.
Armed Parse(const char* text) {
  const char* const colon = std::strrchr(text, ':');
  if (colon == nullptr) Refuse(text);
  std::string number = colon + 1;
  Armed parsed{.name = std::string_view(text, static_cast<size_t>(colon - text)),
               .when_ready = number.starts_with(kReady)};
  if (parsed.when_ready) number.erase(0, kReady.size());
  const bool is_number = absl::SimpleAtoi(number, &parsed.number) && parsed.number >= 1;
  if (!is_number || !IsKnown(parsed.name)) Refuse(text);
  return parsed;
}

const char* Text() { return std::getenv("BALLPISTON_FAILPOINT"); }

}  // namespace

const bool armed = Text() != nullptr;
static const Armed target = armed ? Parse(Text()) : Armed();
static std::atomic<bool> counting = !target.when_ready;

void Pass(std::string_view name) {
  static std::atomic<int64_t> passes = 0;
  if (name == target.name && counting && ++passes == target.number) raise(SIGKILL);
}

void PassSeed(uint64_t seed) {
  const bool is_the_seed = static_cast<uint64_t>(target.number) == seed;
  if (target.name == kCrashForSeed && is_the_seed) raise(SIGSEGV);
}

}  // namespace ballpiston::server::failpoint_internal

namespace ballpiston::server {

void CountFailpointsOfReadyServer() { failpoint_internal::counting = true; }

}  // namespace ballpiston::server
