// A situation in which methods fail, a method, and the failures of all methods in all situations.
// The same for each of three systems: the ball alone, ball and piston, and the gas.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_run.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "tools/stability/failures.h"

namespace ballpiston::stability {

template <typename Geometry>
struct Place {
  Geometry geometry;
  uint64_t starts;  // in the full table
  uint64_t length;  // of each run
};

template <typename Geometry, typename Start>
struct Case {
  std::string name;
  std::vector<Place<Geometry>> places;
  // The start of this number, which does not depend on the starts before it.
  std::function<Start(const Geometry& geometry, uint64_t number)> start;
  // In a case of long runs, the largest |dE/E| that is permitted to methods that promise zeros; 0
  // in a case of short runs.
  double permitted = 0;
};

template <typename Geometry, typename Start>
struct Method {
  std::string name;
  double share;   // of a case's starts, or of the length of long runs; less than 1: a slow method
  bool promised;  // the method promises zeros everywhere
  // Runs each start for this length, and checks it: wall hits of a ball alone, collisions of a
  // pair, or a gas for the time of so many flights of a ball of speed 1.
  Failures (*run)(const Geometry& geometry, std::span<const Start> starts, uint64_t length);
  // Whether the checks are exact enough at this geometry; null: always.
  bool (*can_be_checked)(const Geometry& geometry) = nullptr;
};

// Runs each start by itself.
template <auto run_one, typename Geometry, typename Start>
Failures OneByOne(const Geometry& geometry, std::span<const Start> starts, uint64_t length) {
  Failures failures = {.orbits = starts.size()};
  for (const Start& start : starts) run_one(geometry, start, length, failures);
  return failures;
}

using PairCase = Case<PairGeometry, PairState>;
using GasCase = Case<GasGeometry, GasStart>;

using PairMethod = Method<PairGeometry, PairState>;
using GasMethod = Method<GasGeometry, GasStart>;

// All situations of each system in which methods fail, and all methods: the engines in every
// precision, and the naive methods.
// Cases of the same system have the same random numbers.
std::vector<PairCase> BallCases();
std::vector<PairCase> PairCases();
std::vector<GasCase> GasCases();

std::vector<PairMethod> BallMethods();
std::vector<PairMethod> PairMethods();
std::vector<GasMethod> GasMethods();

// ---- the failures ----

// A method in a case; name, permitted and promised are those of Case and Method.
struct CaseResult {
  std::string name;
  double permitted;
  std::string method;
  bool promised;
  Failures failures;
};

// Starts that run together. They fill the lanes, and fit into memory.
inline constexpr uint64_t kTogether = 4096;

// The number of a method's starts, or the length of its long runs. If even one start is thousands
// of times more than wanted, the method does not run; methods that promise zeros run one start
// nevertheless.
template <typename Method>
uint64_t PartOf(const Method& method, uint64_t all, double effort) {
  constexpr double kFewestWanted = 2e-4;
  const double wanted = static_cast<double>(all) * effort * method.share;
  if (wanted < kFewestWanted && !method.promised) return 0;
  return static_cast<uint64_t>(std::ceil(wanted));
}

template <typename Geometry, typename Start>
Failures RunCase(const Case<Geometry, Start>& one, const Method<Geometry, Start>& method,
                 double effort) {
  const bool is_long = one.permitted > 0;
  Failures failures;
  for (const auto& [geometry, all, full_length] : one.places) {
    if (method.can_be_checked && !method.can_be_checked(geometry)) continue;
    const uint64_t starts = is_long ? all : PartOf(method, all, effort);
    const uint64_t length = is_long ? PartOf(method, full_length, effort) : full_length;
    const uint64_t loops = failures.loops;
    for (uint64_t first = 0; first < starts; first += kTogether) {
      // A loop breaks a promise; the other starts would only cost time.
      if (method.promised && failures.loops > loops) break;
      std::vector<Start> together;
      const uint64_t end = std::min(first + kTogether, starts);
      for (uint64_t i = first; i < end; ++i) together.push_back(one.start(geometry, i));
      failures.Merge(method.run(geometry, together, length));
    }
  }
  return failures;
}

// Runs each case with each method. Multiplies the number of starts of each case by `effort` and the
// method's share. In cases of long runs it runs all starts and multiplies their length instead. All
// methods have the same starts. Prints progress on standard error.
template <typename Geometry, typename Start>
std::vector<CaseResult> RunCases(const std::vector<Case<Geometry, Start>>& cases,
                                 const std::vector<Method<Geometry, Start>>& methods,
                                 double effort) {
  std::vector<CaseResult> results;
  for (const Case<Geometry, Start>& one : cases) {
    std::cerr << "stability: " << one.name << std::endl;
    for (const Method<Geometry, Start>& method : methods) {
      results.push_back(
          {one.name, one.permitted, method.name, method.promised, RunCase(one, method, effort)});
    }
  }
  return results;
}

}  // namespace ballpiston::stability
