// The rules that hold for the answer to a question. README.md lists them. A check throws Violation.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_summary.h"
#include "core/model_choice/ladder.h"
#include "tests/support/preamble.h"

namespace ballpiston::questions {

// No question computes for ever; no call fails. If one of these rules is broken, ServerAsker may
// start a new server.
inline constexpr char kEndCheck[] = "end", kCallCheck[] = "call";

struct Violation : std::runtime_error {
  Violation(const std::string& check, const std::string& what)
      : std::runtime_error(what), check(check) {}

  std::string check;  // the name of the broken rule
};

template <typename... What>
void Require(bool is_so, const char* check, const What&... what) {
  if (!is_so) throw Violation(check, absl::StrCat(what...));
}

// A question that was planned at 0.1 s or less, and takes more processor time than this, is
// reported as one that never ends.
#ifdef BALLPISTON_SANITIZED
inline constexpr int kMostProcessorSeconds = 200;
#else
inline constexpr int kMostProcessorSeconds = 30;
#endif

// A refusal must name the field, the value that the question had, and the permitted values.
// `violations`: those of `spec`, with paths that begin with "spec.".
void CheckRefusal(const v1::EnsembleSpec& spec, const std::vector<FieldViolation>& violations);

// The plan of a point, by all models. The model that would answer has a number of samples and a
// time of thirty thousand years of a processor at most: a question that takes longer has to be
// refused. No number of any model is negative, NaN or infinite. Returns the planned processor time.
double CheckPlan(const v1::PointPlan& plan);

// ---- memory: a computation takes at most what was planned (core/ensemble/experiment_kind.h) ----

// Code that runs for the first time, caches of closed forms, and the answer itself, in bytes.
inline constexpr double kMemoryOfAnyAnswer = 3e7;

// The largest memory of this process since the object was made, above that of the beginning, in
// bytes. At most one object at a time.
class PeakMemory {
 public:
  PeakMemory();
  double Bytes() const;

 private:
  double at_first_;
};

// Under a sanitizer, which takes memory of its own, every measured value passes.
void CheckMemory(double planned, double measured);

// ---- the answer at each point ----

void CheckFinite(const google::protobuf::Message& message);

// The same for a summary, which still has the numbers that the server leaves out of a message.
void CheckFinite(const PointSummary& summary);

// With at least so many samples a result needs an error, or a remark that says why there is none.
inline constexpr double kEnoughSamples = 1000;

// finite, false zero, measured, health and law.
void CheckAnswer(const v1::EnsembleSpec& spec, const v1::PointResult& result);

// ---- agreement: all models that answer a question agree within their stated errors ----
//
// Two models agree in an estimate if the difference is at most 5 times the statistical errors,
// added in quadrature, plus both model errors. An estimate also agrees with the exact value beside
// it. Distances between laws are compared only from equal numbers of samples. A model takes part if
// it computes at least 1,000 samples in the permitted time, and if its model error is known. Each
// model has random numbers of its own.
//
// A difference counts only if it is seen again with other random numbers and four times the
// samples. False alarms: a normal deviate exceeds 5 sigma with probability 5.7e-7, twice with
// 3e-13. Estimates from 1,000 samples are skewed; with a probability as large as 1e-4 of such a
// deviation, 20,000 questions with 20 comparisons each give a false alarm in 250 runs.

// At the first point of the question. `most_seconds`: for each model, on `machine`.
void CheckAgreement(const EnsembleSpec& spec, const Machine& machine, double most_seconds);

// Compares one answer of each model. Returns a description of each difference, by the name of the
// compared numbers.
std::map<std::string, std::string> Disagreements(const std::vector<v1::PointResult>& answers);

}  // namespace ballpiston::questions
