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

struct Armed {
  std::string_view name;
  int64_t pass = 0;
};

[[noreturn]] void Refuse(const char* text) {
  std::fprintf(stderr, "BALLPISTON_FAILPOINT=%s is not NAME:N with a failpoint's name and N >= 1\n",
               text);
  std::_Exit(2);
}

// The environment's memory, which nobody changes.
Armed Parse(const char* text) {
  const std::string_view whole(text);
  const size_t colon = whole.rfind(':');
  if (colon == std::string_view::npos) Refuse(text);
  Armed parsed{whole.substr(0, colon)};
  const char* const end = whole.data() + whole.size();
  const auto [rest, error] = std::from_chars(whole.data() + colon + 1, end, parsed.pass);
  const bool number = error == std::errc() && rest == end && parsed.pass >= 1;
  const bool known =
      std::find(kFailpoints.begin(), kFailpoints.end(), parsed.name) != kFailpoints.end();
  if (!number || !known) Refuse(text);
  return parsed;
}

const char* Text() { return std::getenv("BALLPISTON_FAILPOINT"); }

}  // namespace

const bool armed = Text() != nullptr;
static const Armed target = armed ? Parse(Text()) : Armed();

void Pass(std::string_view name) {
  static std::atomic<int64_t> passes = 0;
  if (name == target.name && ++passes == target.pass) raise(SIGKILL);
}

}  // namespace ballpiston::server::failpoint_internal
