// What holds for the answer at each point:
//   finite       no number is NaN or infinite
//   false zero   an error of 0 is stated for exact values alone, and no error is below the rounding
//                of its value
//   measured     something was measured, or a remark says why not
//   health       no orbit left its cell, and the energy is conserved
//   law          the expected probabilities of a law sum to 1
#pragma once

#include "ballpiston/v1/result.pb.h"
#include "ballpiston/v1/spec.pb.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kFalseZeroCheck[] = "false zero";
inline constexpr char kMeasuredCheck[] = "measured";
inline constexpr char kHealthCheck[] = "health";
inline constexpr char kLawCheck[] = "law";

// With so many samples a result needs an error, or a remark that says why there is none.
inline constexpr double kEnoughSamples = 1000;

Findings CheckAnswer(const v1::EnsembleSpec& spec, const v1::PointResult& result);

}  // namespace ballpiston::questions
