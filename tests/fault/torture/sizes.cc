#include "tests/fault/torture/sizes.h"

#include "tests/support/preamble.h"

namespace ballpiston::torture {

double ShareOfFullSize() {
  const char* const share = std::getenv("BALLPISTON_TORTURE");
  return share == nullptr ? 0 : std::clamp(std::atof(share), 0.0, 1.0);
}

int Size(int brief, int full) {
  return std::max(brief, static_cast<int>(ShareOfFullSize() * full));
}

bool HoldsToTimes() { return ShareOfFullSize() > 0; }

}  // namespace ballpiston::torture
