// Computes the answer at a point in this process, as the server does.
#pragma once

#include <cstddef>
#include <optional>

#include "ballpiston/v1/result.pb.h"
#include "core/ensemble/point_experiment.h"
#include "core/model_choice/ladder.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

// The source of a ladder that knows no pilot.
inline std::optional<Pilot> NoPilot(const PilotPlace&) { return std::nullopt; }

struct ComputedPoint {
  v1::PointResult result;
  Findings findings;  // numbers that are not finite, which the message leaves out
};

// The spec has no violations and no budget.
ComputedPoint ComputePoint(const EnsembleSpec& spec, size_t index, const Answer& answer);

// Starts the computation and stops it where the engine first asks whether to stop.
void StartAndStop(const EnsembleSpec& spec, size_t index, const Answer& answer);

// The number of samples that `model` is planned to compute in `seconds` at the point `index`. For a
// model without samples: a number above any other.
double SamplesIn(double seconds, const EnsembleSpec& spec, size_t index, Model model,
                 const Machine& machine);

// The same question with a number of samples, or of collisions, in the place of its target.
EnsembleSpec WithSamples(EnsembleSpec spec, double samples);

}  // namespace ballpiston::questions
