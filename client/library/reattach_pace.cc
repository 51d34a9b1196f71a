#include "client/library/reattach_pace.h"

#include <algorithm>

namespace ballpiston::client {

ReattachPace::ReattachPace(const WatchOptions& options, Time now)
    : options_(options), heard_(now), backoff_(options.initial_backoff) {}

void ReattachPace::Heard(Time now) {
  heard_ = now;
  backoff_ = options_.initial_backoff;
}

std::optional<absl::Duration> ReattachPace::NextPause(Time now, absl::Duration least) {
  const absl::Duration pause = std::max(backoff_, least) * absl::Uniform(random_, 1.0, 1.25);
  backoff_ = std::min(2 * backoff_, options_.max_backoff);
  const absl::Duration silence = absl::FromChrono(now - heard_);
  if (silence + pause > options_.give_up_after) return std::nullopt;
  return pause;
}

}  // namespace ballpiston::client
