// A refusal names the field, the value as it was given, and the permitted values.
#ifndef BALLPISTON_TESTS_QUESTIONS_REFUSAL_CHECK_H_
#define BALLPISTON_TESTS_QUESTIONS_REFUSAL_CHECK_H_

#include <vector>

#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kRefusalCheck[] = "refusal";

// `violations`: those of `spec`, with paths that begin with "spec.".
Findings CheckRefusal(const v1::EnsembleSpec& spec, const std::vector<FieldViolation>& violations);

}  // namespace ballpiston::questions

#endif  // BALLPISTON_TESTS_QUESTIONS_REFUSAL_CHECK_H_
