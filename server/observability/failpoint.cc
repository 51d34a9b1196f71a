#include "server/observability/failpoint.h"

#include <signal.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace ballpiston::server::failpoint_internal {
namespace {

constexpr std::string_view kReady = "ready+";

struct Armed {
  std::string_view name;
  bool when_ready = false;
  int64_t pass = 0;
};

[[noreturn]] void Refuse(const char* text) {
  std::fprintf(stderr,
               "BALLPISTON_FAILPOINT=%s is not NAME:N or NAME:ready+N with a failpoint's name and "
               "N >= 1\n",
               text);
  std::_Exit(2);
}

// `text` points into the environment, which nobody changes.
Armed Parse(const char* text) {
  const std::string_view whole(text);
  const size_t colon = whole.rfind(':');
  if (colon == std::string_view::npos) Refuse(text);
  std::string_view number_text = whole.substr(colon + 1);
  Armed parsed{whole.substr(0, colon), number_text.starts_with(kReady)};
  if (parsed.when_ready) number_text.remove_prefix(kReady.size());
  const char* const end = number_text.data() + number_text.size();
  const auto [rest, error] = std::from_chars(number_text.data(), end, parsed.pass);
  const bool number = error == std::errc() && rest == end && parsed.pass >= 1;
  const bool known =
      parsed.name == kCrashForSeed ||
      std::find(kFailpoints.begin(), kFailpoints.end(), parsed.name) != kFailpoints.end();
  if (!number || !known) Refuse(text);
  return parsed;
}

const char* Text() { return std::getenv("BALLPISTON_FAILPOINT"); }

}  // namespace

const bool armed = Text() != nullptr;
static const Armed target = armed ? Parse(Text()) : Armed();
static std::atomic<bool> counting = !target.when_ready;

void Pass(std::string_view name) {
  static std::atomic<int64_t> passes = 0;
  if (name == target.name && counting && ++passes == target.pass) raise(SIGKILL);
}

void CrashForSeed(uint64_t seed) {
  const bool is_the_seed = static_cast<uint64_t>(target.pass) == seed;
  if (target.name == kCrashForSeed && is_the_seed) raise(SIGSEGV);
}

}  // namespace ballpiston::server::failpoint_internal

namespace ballpiston::server {

void CountFailpointsOfReadyServer() { failpoint_internal::counting = true; }

}  // namespace ballpiston::server
