// The methods that fly a ball alone, behind one function each: the engines in every precision, and
// the naive methods beside them.
#ifndef BALLPISTON_TOOLS_STABILITY_BALL_METHODS_H_
#define BALLPISTON_TOOLS_STABILITY_BALL_METHODS_H_

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

struct BallMethod {
  std::string name;
  double share;   // of a case's starts: all for what is promised to hold, fewer for slow methods
  bool promised;  // to show zeros everywhere
  bool naive;

  // Each ball makes that many wall hits, watched one by one.
  Failures (*fly)(const PairGeometry& geometry, std::span<const PairState> starts, uint64_t hits);

  // Where each ball is after that many hits, back again after as many with its velocity reversed.
  // The distance from its start; starts are on a wall.
  std::vector<double> (*there_and_back)(const PairGeometry& geometry,
                                        std::span<const PairState> starts, uint64_t hits);
};

const std::vector<BallMethod>& BallMethods();

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_BALL_METHODS_H_
