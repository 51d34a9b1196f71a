// What the harness asks: small specifications of each kind, and their undisturbed answers.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_QUESTIONS_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_QUESTIONS_H_

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"

namespace ballpiston::torture {

// Of every experiment, by several models, of one and of many points, with numbers of samples and
// with a tolerance; between 0.02 s and 1 s of one core each.
std::vector<v1::EnsembleSpec> Questions();

// Many points, each of much the same cost.
v1::EnsembleSpec ManyPoints(int points, int64_t samples);

// Never ends by itself; saturates the workers with blocks of some 50 ms.
v1::EnsembleSpec Endless();

template <typename Value>
Value OrThrow(absl::StatusOr<Value> value) {
  if (!value.ok()) throw std::runtime_error(value.status().ToString());
  return *std::move(value);
}

// A point's result, serialized, by its index.
using Answer = std::map<int, std::string>;

Answer AnswerOf(const std::vector<v1::PointResult>& points);

// Each question answered once by a server that nobody disturbs. Checks that every point with a
// number of samples has as many as the plan of its blocks says; throws if not.
std::vector<Answer> UndisturbedAnswers(const std::vector<v1::EnsembleSpec>& questions);

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_QUESTIONS_H_
