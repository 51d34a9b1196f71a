// The specifications of the torture tests, and their answers by a server that is not killed.
#pragma once

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "tests/support/preamble.h"

namespace ballpiston::torture {

// Specifications of every experiment, by several models, with one point and with many, with a
// number of samples and with a tolerance. Each takes 0.02 s to 1 s of one core, or some seconds in
// the long form.
std::vector<v1::EnsembleSpec> Questions();

// Questions of some seconds of one core, in both forms.
std::vector<v1::EnsembleSpec> LargeQuestions();

// Many points of similar cost.
v1::EnsembleSpec ManyPoints(int points, int64_t samples);

// Never ends by itself; saturates the workers with turns of some 50 ms.
v1::EnsembleSpec Endless();

template <typename Value>
Value OrThrow(absl::StatusOr<Value> value) {
  if (!value.ok()) throw std::runtime_error(value.status().ToString());
  return *std::move(value);
}

// A point's result, serialized, by its index.
using Answer = std::map<int, std::string>;

Answer AnswerOf(const std::vector<v1::PointResult>& points);

// The answers of a server that is not killed. Throws if a point with a number of samples has
// another number than its plan gives.
std::vector<Answer> UndisturbedAnswers(const std::vector<v1::EnsembleSpec>& questions);

}  // namespace ballpiston::torture
