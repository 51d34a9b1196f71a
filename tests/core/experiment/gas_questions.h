// Functions that the tests of the gas's experiments share.
#pragma once

#include <gmock/gmock.h>

#include <string>

#include "core/ensemble/point_experiment.h"
#include "tests/core/one_point_spec.h"

namespace ballpiston {

// The summary of measured replicas by the spec's experiment.
inline PointSummary Summarized(const EnsembleSpec& spec, const BlockResult& merged) {
  return PointExperiment::Create(spec, 0)->Summarize(merged);
}

// A violation of the field whose description contains the text.
inline auto Violates(const std::string& field, const std::string& text) {
  return testing::AllOf(testing::Field(&FieldViolation::field, field),
                        testing::Field(&FieldViolation::description, testing::HasSubstr(text)));
}

}  // namespace ballpiston
