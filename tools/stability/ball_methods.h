// The methods that move a ball alone: the engines in every precision, and the naive methods. Each
// method is one function.
#pragma once

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
  double share;   // of a case's starts; less than 1 for slow methods
  bool promised;  // the method promises zeros everywhere
  bool naive;

  // Each ball makes `hits` wall hits. Every hit is checked.
  Failures (*fly)(const PairGeometry& geometry, std::span<const PairState> starts, uint64_t hits);

  // Each ball makes `hits` wall hits, is reversed, and makes as many hits back. Returns the
  // distance of each ball from its start; starts are on a wall.
  std::vector<double> (*there_and_back)(const PairGeometry& geometry,
                                        std::span<const PairState> starts, uint64_t hits);
};

const std::vector<BallMethod>& BallMethods();

}  // namespace ballpiston::stability
