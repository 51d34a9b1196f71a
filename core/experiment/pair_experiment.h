// Functions that the rows of the ball-piston pair's experiments share.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/experiment/predicted_hits.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

inline constexpr ParameterUse kPairAlone[] = {{&kRho}, {&kDelta}};

inline constexpr Model kBilliards[] = {Model::kBilliard, Model::kBilliardReference};

// Requires a valid rho and delta.
PairGeometry GeometryOf(const PointParameters& point);

using DeltaValidation = absl::Status (*)(double rho, double delta);

// Finds deltas that are not permitted at the largest rho, and deltas so small that the mean free
// time of the smallest rho is so large that its powers leave the range of double.
void CheckDeltas(const Grid& grid, DeltaValidation validate, std::vector<FieldViolation>& found);

// Whether a billiard engine of the spec's precision is sound at the point
// (billiard/billiard_domain.h).
bool IsSoundForBilliard(const EnsembleSpec& spec, const PointParameters& point);

// Whether model AUTO has another model than the billiard for the question at this point: a closed
// form, or the limit with an error that is known and within the target's tolerance. Without a
// tolerance or a budget the limit does not answer. Requires a spec without violations.
bool IsAnsweredWithoutBilliard(const EnsembleSpec& spec, const PointParameters& point);

// Finds rho and delta outside of the billiard's domain, in the spec's precision, if a billiard has
// to answer there. For pairs and for gases.
void CheckBilliardDomain(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

// CheckDeltas with the bound of a pair, and CheckBilliardDomain.
void CheckPairGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

inline double OneCollision(Model, const PointParameters&) { return 1; }

// An engine and its blocks. Measured: up to 8.4 MB, by return experiments with blocks of 65,536.
inline double MemoryOfPairs(Model, const PointParameters&) { return 12e6; }

// The work of a sample that is one collision of an orbit in equilibrium.
SampleWork WorkOfACollision(const PairGeometry& geometry);

}  // namespace ballpiston
