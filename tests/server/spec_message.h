// The core's specification as a message of the API: the inverse of CheckSpec. The server never
// needs it.
#pragma once

#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/ensemble_spec.h"

namespace ballpiston::server {

// The values of `cells` must be codes of shapes.
v1::EnsembleSpec SpecMessage(const EnsembleSpec& spec);

}  // namespace ballpiston::server
