// No number is NaN or infinite.
#ifndef BALLPISTON_TESTS_QUESTIONS_FINITE_CHECK_H_
#define BALLPISTON_TESTS_QUESTIONS_FINITE_CHECK_H_

#include <google/protobuf/message.h>

#include "core/ensemble/point_summary.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kFiniteCheck[] = "finite";

Findings CheckFinite(const google::protobuf::Message& message);

// Before the server leaves out what is not finite.
Findings CheckFinite(const PointSummary& summary);

}  // namespace ballpiston::questions

#endif  // BALLPISTON_TESTS_QUESTIONS_FINITE_CHECK_H_
