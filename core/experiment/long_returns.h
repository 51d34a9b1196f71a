// Whether a sample of return times can tell its own error.
//
// With a slow piston (epsilon -> 0) or a slow ball (epsilon -> 1/2) most returns are short, as if
// the slow one rested, and the mean is carried by few that are very long: the piston goes to its
// far wall and back, or the ball crosses the cell. The closed forms tell how much of the mean that
// is, so how many such returns `samples` are expected to hold. Where these are few, the scatter of
// the sample says nothing of what it has not seen, and no error may be given.
//
// At exactly epsilon = 0 there are no long returns, but the variance is infinite: a start at depth
// t below the tip returns after a time of order 1/t (lambda + t), with density t (lambda + t).
#ifndef BALLPISTON_CORE_EXPERIMENT_LONG_RETURNS_H_
#define BALLPISTON_CORE_EXPERIMENT_LONG_RETURNS_H_

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// Expected number of them, in units of one sample; about 1 or more where they are not rare. 0 at
// epsilon = 0: no number of samples is enough. Infinite at epsilon = 1/2, where the ball rests and
// return times are bounded.
double LongReturnsPerSample(const PairGeometry& geometry, double epsilon);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_LONG_RETURNS_H_
