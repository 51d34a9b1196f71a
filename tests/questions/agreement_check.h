// The answers of all models that answer a question agree within their stated errors.
//
// Two models agree in an estimate if the difference is at most 5 times the statistical errors,
// added in quadrature, plus both model errors. An estimate also agrees with the exact value beside
// it. Of a distance between laws, the part above its noise floor is compared, which does not depend
// on the number of samples. A model takes part if it computes at least 1,000 samples in the
// permitted time, and if its model error is known. Each model has random numbers of its own.
//
// A difference counts only if it is seen again with other random numbers and four times the
// samples. False alarms: a normal deviate exceeds 5 sigma with probability 5.7e-7, twice with
// 3e-13. Estimates from 1,000 samples are skewed; with a probability as large as 1e-4 of such a
// deviation, 20,000 questions with 20 comparisons each give a false alarm in 250 runs.
#pragma once

#include <vector>

#include "ballpiston/v1/result.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/model_choice/ladder.h"
#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kAgreementCheck[] = "agreement";

// At the first point of the question. `most_seconds`: for each model, on `machine`.
Findings CheckAgreement(const EnsembleSpec& spec, const Machine& machine, double most_seconds);

// The comparisons alone, of one answer by each model.
Findings Disagreements(const std::vector<v1::PointResult>& answers);

}  // namespace ballpiston::questions
