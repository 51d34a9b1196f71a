// A machine to predict for, and pilots that are made up.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "core/ensemble/experiment_kind.h"
#include "core/experiment/expected_limit_error.h"
#include "core/model_choice/ladder.h"
#include "tests/core/asked.h"

namespace ballpiston {

// Round numbers near those of a processor of the day.
inline Machine SomeMachine() {
  Machine machine;
  machine.rates.closed_form = 1e-6;
  machine.rates.spectrum = 1e-4;
  machine.rates.jump = 5e-8;
  machine.rates.lanes = {.wall_hit = 2e-9, .collision = 2e-7, .sample = 4e-7};
  machine.rates.lanes_single = {.wall_hit = 1e-9, .collision = 2e-7, .sample = 4e-7};
  machine.rates.reference = {.wall_hit = 4e-8, .collision = 4e-8, .sample = 2e-7};
  machine.workers = 1;
  return machine;
}

inline EnsembleSpec Relaxation(double delta, const Target& target = {}) {
  return SpecOf(&kEnergyRelaxation, PaperPoint(delta), target);
}

// Returns the same pilot for every place, and records the places.
class MadeUpPilots {
 public:
  explicit MadeUpPilots(std::optional<Pilot> pilot) : pilot_(pilot) {}
  PilotSource source() {
    return [this](const PilotPlace& place) {
      asked_.push_back(place);
      return pilot_;
    };
  }
  const std::vector<PilotPlace>& asked() const { return asked_; }

 private:
  std::optional<Pilot> pilot_;
  std::vector<PilotPlace> asked_;
};

inline std::optional<Pilot> MayNotBeAsked(const PilotPlace&) {
  ADD_FAILURE() << "a pilot where none can decide";
  return std::nullopt;
}

inline std::optional<Pilot> Unknown(const PilotPlace&) { return std::nullopt; }

inline std::optional<Answer> Choice(const EnsembleSpec& spec,
                                    const PilotSource& pilots = MayNotBeAsked,
                                    const Machine& machine = SomeMachine()) {
  EXPECT_TRUE(Violations(spec).empty());
  return ChooseAnswer(spec, PointAt(spec, 0), machine, pilots);
}

inline Ladder Planned(const EnsembleSpec& spec, const Machine& machine = SomeMachine(),
                      const PilotSource& pilots = Unknown) {
  return LadderFor(spec, PointAt(spec, 0), machine, pilots);
}

}  // namespace ballpiston
