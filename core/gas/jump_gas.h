// The gas in the limit of rare collisions: a jump process of the energies. A ball and a piston that
// can meet exchange v1 and v3 at a rate that depends on their energies. In a contact the ball's
// angle is uniform and both signs of the piston's velocity are equally likely, with the weight (v1
// - v3)+. So the energies follow the kernel W of the pair (markov/jump_process.h), which is
// homogeneous: rates scale with the root of the energy.
//
// The process is sampled by thinning in two steps. (v1 - v3)+ is at most (v1)+ + (-v3)+, whose
// means are v_b/pi and v_p/2. So each body proposes exchanges at a rate that depends only on its
// speed. A proposal is accepted with the probability (v1 - v3)+/((v1)+ + (-v3)+), seven times in
// ten. To draw a body at its rate, any body is drawn, and accepted with the ratio of its speed to
// the largest speed, once in four. So the cost of an exchange hardly grows with the size of the
// gas, until the gas exceeds the caches. An outermost piston gets a new thermal velocity at every
// proposal, because it hits its thermal wall many times between two exchanges.
//
// Units are those of the billiard: a contact at given energies has the rate `density` <(v1 - v3)+>;
// its mean at temperature T is density sqrt(T/pi).
// Properties, each with the test that bears its name:
//   1. PairsFollowTheJumpProcess.  2. HasItsExactRateAndItsGammaLaws.
//   3. TheJumpProcessBetweenReservoirsIsThatOfAPlainProgram.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/gas/gas_meter.h"
#include "core/gas/gas_state.h"
#include "core/gas/jump_draws.h"
#include "core/gas/thermal_walls.h"
#include "core/sampling/counter_random.h"

namespace ballpiston {

class JumpGas {
 public:
  // At least one ball or piston must move.
  JumpGas(const GasGeometry& geometry, double density, const GasState& start, ThermalWalls walls,
          const CounterRandom& random);

  // Exchanges until `time`, and reports the exchanges to the meter. There an outermost piston has
  // its mean energy. Returns false after some 2 ms; then it must be called again with the same
  // time.
  bool AdvanceToward(double time, GasMeter& meter);

  // The speeds, from which another object can begin: the process has no memory. An outermost piston
  // has its mean energy.
  GasState State() const;

 private:
  // An exchange. In the direction in which the ball sees the piston, v1 is the ball's velocity and
  // v3 the piston's.
  struct Proposal {
    int64_t ball = 0;
    int64_t piston = 0;
    Direction direction = Direction::kRight;
    double v1 = 0;
    double v3 = 0;
  };

  double SpeedAtStart(size_t body, const GasState& start) const;
  double SpeedOfOutermost(int64_t piston) const;
  void DrawAttempts();
  void FindRates();
  void FindPlaces();
  // Inline, which saves 8 % of the time of an exchange. FindNext is called at two places.
  inline void Exchange(GasMeter& meter);
  [[gnu::always_inline]] inline void FindNext();
  inline size_t NextAttempt();
  inline void ByBall(int64_t ball, uint64_t bits, double cosine);
  inline void ByPiston(int64_t piston, uint64_t bits, double cosine);
  inline double RatePerSpeed(size_t body) const;
  inline void SetSpeed(size_t body, double speed);

  GasGeometry geometry_;
  double density_;
  ThermalWalls walls_;
  CounterRandom random_;
  size_t balls_;
  // The balls' speeds, then the pistons'. An outermost piston has the speed that gives its rate of
  // proposals.
  std::vector<double> speeds_;
  JumpKinds kinds_;             // balls, pistons
  double rate_ = 0;             // of all proposals
  size_t changes_ = 0;          // since the rates were found
  JumpAttempts attempts_ = {};  // drawn in advance, so that the speeds can be prefetched
  size_t used_attempts_ = kJumpDraws;
  JumpProposals proposals_ = {};
  size_t used_proposals_ = kJumpDraws;
  double time_ = 0;  // of the next exchange
  Proposal next_ = {};
};

}  // namespace ballpiston
