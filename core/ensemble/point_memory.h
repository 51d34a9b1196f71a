// The memory that the computation of a point takes, known before it starts. The scheduler keeps the
// sum over the running points below a limit, and a question beyond the machine's memory is
// rejected.
#pragma once

#include "core/ensemble/ensemble_spec.h"

namespace ballpiston {

// Upper bound of the bytes of a point while up to `threads` threads compute it: the state of the
// engines, the blocks in progress, and the results that wait to be merged. Uses spec.model; for
// AUTO the billiard, unless a closed form answers. The spec must have no violations.
double MemoryOf(const EnsembleSpec& spec, const PointParameters& point, int threads);

// The same for a thread alone: the state of one engine and its blocks.
double MemoryOfAThread(const EnsembleSpec& spec, const PointParameters& point);

}  // namespace ballpiston
