// Functions that the rows of conditional-mean-free-time and first-hit share. A sample is a return
// to the collision surface at fixed energies.
#pragma once

#include <vector>

#include "core/ensemble/experiment_kind.h"

namespace ballpiston {

SampleWork WorkOfAReturn(Model model, const PointParameters& point);

// The relative error of the mean return time for one sample. Rare long returns dominate the mean,
// so the scatter of their number is its error.
double ErrorOfAReturn(Model, const PointParameters& point);

// The events of a return for its error: the expected number of long returns, where these are rare.
double EventsOfAReturn(Model model, const PointParameters& point);

// Finds a tolerance at epsilon = 0, where the return time has no variance.
void CheckToleranceOfReturns(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

}  // namespace ballpiston
