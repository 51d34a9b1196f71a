// A refusal names the field, the value as it was given, and the permitted values.
#pragma once

#include <vector>

#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kRefusalCheck[] = "refusal";

// `violations`: those of `spec`, with paths that begin with "spec.".
Findings CheckRefusal(const v1::EnsembleSpec& spec, const std::vector<FieldViolation>& violations);

}  // namespace ballpiston::questions
