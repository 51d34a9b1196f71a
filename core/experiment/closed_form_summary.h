// Experiments answered by the paper's closed forms, exact at every delta.
#ifndef BALLPISTON_CORE_EXPERIMENT_CLOSED_FORM_SUMMARY_H_
#define BALLPISTON_CORE_EXPERIMENT_CLOSED_FORM_SUMMARY_H_

#include "core/experiment/ensemble_spec.h"
#include "core/experiment/point_summary.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// The experiment's estimates; their standard errors are the bounds of the formulas' rounding.
// Requires HasClosedForm (answering_models.h).
PointSummary ClosedFormSummary(Experiment experiment, const PairGeometry& geometry,
                               const PointParameters& point);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_CLOSED_FORM_SUMMARY_H_
