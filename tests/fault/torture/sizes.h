// The size of the torture tests. By default each takes five seconds of one core or less, except the
// two tests Kills, which start a server for each failpoint. BALLPISTON_TORTURE=1 in the environment
// (`make torture`) selects the full size, 0.1 a tenth.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace ballpiston::torture {

// The share of the full size; 0 in the short form.
inline double ShareOfFullSize() {
  const char* const share = std::getenv("BALLPISTON_TORTURE");
  return share == nullptr ? 0 : std::clamp(std::atof(share), 0.0, 1.0);
}

// `brief` in the short form; otherwise the share of `full`, at least `brief`.
inline int Size(int brief, int full) {
  return std::max(brief, static_cast<int>(ShareOfFullSize() * full));
}

// Whether to check times. A busy machine may miss them without an error of the server.
inline bool HoldsToTimes() { return ShareOfFullSize() > 0; }

}  // namespace ballpiston::torture
