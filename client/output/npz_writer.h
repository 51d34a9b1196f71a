// A result as NumPy arrays: an archive of .npy files, which numpy.load reads. The first axis of
// each array is the points. What does not exist is NaN, and shorter rows end with NaN. An array of
// NaN alone is left out.
//
//   index, rho, delta, ...       position in the grid, and the parameters; `cells` is text
//   model, samples
//   NAME, NAME_standard_error, NAME_exact, NAME_z_score, NAME_model_error, NAME_noise_floor,
//   NAME_limit, NAME_batches     of each estimate, those that some point has
//   kl_divergence, kl_divergence_noise_floor, _cells, _noise_error, _standard_error
//   health_escapes, health_max_energy_error
//   histogram_NAME_counts, _expected (points, bins), _lower, _upper (points); NAME ends with _plus
//                                or _minus for the two signs sigma of an angle; if the histograms
//                                have times, (points, times, bins), and _time (points, times)
//   curve_NAME_time or _position, _value, _standard_error, _limit (points, length)
//   provenance                   text: JSON with job, engine_version, client_version and spec
#pragma once

#include <memory>
#include <ostream>

#include "client/output/result_writer.h"

namespace ballpiston::client {

// Keeps all points until the end. If libzip cannot make the archive, `out` fails.
std::unique_ptr<ResultWriter> NewNpzWriter(std::ostream& out);

}  // namespace ballpiston::client
