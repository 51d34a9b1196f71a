#include "server/convert/method.h"

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/arithmetic/number_text.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston::server {
namespace {

class ViolationList {
 public:
  void Add(const std::string& field, const absl::Status& status) {
    if (!status.ok()) list_.push_back({field, std::string(status.message())});
  }
  void AddOutside(const char* field, double value, const std::string& range) {
    list_.push_back({field, absl::StrCat(NumberText(value), " is not in ", range)});
  }
  std::vector<FieldViolation> Taken() { return std::move(list_); }

 private:
  std::vector<FieldViolation> list_;
};

// False for NaN.
bool IsWithin(double low, double value, double high) { return value >= low && value <= high; }

// As far as can be told where rho itself is not permitted.
absl::Status ValidateDelta(double rho, double delta) {
  return ValidateRho(rho).ok() ? ValidatePairDelta(rho, delta) : ValidateSomeDelta(delta);
}

absl::Status ValidateCountOfDeltas(size_t count) {
  if (count <= kMaxRelaxationDeltas) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(count, " values; permitted: at most ", kMaxRelaxationDeltas));
}

void CheckRelaxationDeltas(const MethodComparisonSpec& spec, ViolationList& violations) {
  const absl::Status count = ValidateCountOfDeltas(spec.relaxation_deltas.size());
  violations.Add("relaxation_delta", count);
  if (!count.ok()) return;  // no word on each of thousands
  for (size_t i = 0; i < spec.relaxation_deltas.size(); ++i) {
    violations.Add(absl::StrCat("relaxation_delta[", i, "]"),
                   ValidateDelta(spec.rho, spec.relaxation_deltas[i]));
  }
}

std::vector<FieldViolation> Check(const MethodComparisonSpec& spec) {
  ViolationList violations;
  violations.Add("rho", ValidateRho(spec.rho));
  violations.Add("delta", ValidateDelta(spec.rho, spec.delta));
  CheckRelaxationDeltas(spec, violations);
  if (!(spec.epsilon > 0 && spec.epsilon < 0.5)) {
    violations.AddOutside("epsilon", spec.epsilon, "(0, 1/2)");
  }
  if (!IsWithin(kMinSecondsPerCurve, spec.seconds_per_curve, kMaxSecondsPerCurve)) {
    violations.AddOutside(
        "seconds_per_curve", spec.seconds_per_curve,
        absl::StrCat("[", NumberText(kMinSecondsPerCurve), ", ", NumberText(kMaxSecondsPerCurve),
                     "], or 0 for ", NumberText(kDefaultSecondsPerCurve)));
  }
  return violations.Taken();
}

std::vector<double> RelaxationDeltas(const v1::CompareMethodsRequest& request) {
  const auto& asked = request.relaxation_delta();
  if (!asked.empty()) return {asked.begin(), asked.end()};
  std::vector<double> deltas;
  for (const double delta : kDefaultRelaxationDeltas) {
    if (ValidateDelta(request.rho(), delta).ok()) deltas.push_back(delta);
  }
  return deltas;
}

}  // namespace

CheckedComparison CheckComparison(const v1::CompareMethodsRequest& request) {
  CheckedComparison checked;
  checked.spec.rho = request.rho();
  checked.spec.delta = request.delta();
  checked.spec.epsilon = request.epsilon();
  checked.spec.seconds_per_curve =
      request.seconds_per_curve() == 0 ? kDefaultSecondsPerCurve : request.seconds_per_curve();
  checked.spec.seed = request.seed();
  checked.spec.relaxation_deltas = RelaxationDeltas(request);
  checked.violations = Check(checked.spec);
  return checked;
}

v1::MethodMeasurement MeasurementMessage(const MethodMeasurement& measurement) {
  v1::MethodMeasurement message;
  message.set_method(MethodMessage(measurement.method));
  message.set_time_step(measurement.time_step);
  message.set_quantity(QuantityMessage(measurement.quantity));
  message.set_delta(measurement.delta);
  message.set_samples(measurement.samples);
  message.set_wall_hits(measurement.wall_hits);
  message.set_work(measurement.work);
  message.set_value(measurement.value);
  message.set_statistical_error(measurement.statistical_error);
  return message;
}

v1::MethodMeasurement::Method MethodMessage(Method method) {
  switch (method) {
    case Method::kFixedStep:
      return v1::MethodMeasurement::FIXED_STEP;
    case Method::kReferenceSingle:
      return v1::MethodMeasurement::BILLIARD_REFERENCE_SINGLE;
    case Method::kReference:
      return v1::MethodMeasurement::BILLIARD_REFERENCE;
    case Method::kReferenceLongDouble:
      return v1::MethodMeasurement::BILLIARD_REFERENCE_LONG_DOUBLE;
    case Method::kReferenceQuadruple:
      return v1::MethodMeasurement::BILLIARD_REFERENCE_QUADRUPLE;
    case Method::kLanes:
      return v1::MethodMeasurement::BILLIARD;
    case Method::kLanesSingle:
      return v1::MethodMeasurement::BILLIARD_SINGLE;
    case Method::kClosedForm:
      return v1::MethodMeasurement::CLOSED_FORM;
    case Method::kMarkov:
      return v1::MethodMeasurement::MARKOV;
    case Method::kSpectrum:
      return v1::MethodMeasurement::SPECTRUM;
  }
  return v1::MethodMeasurement::METHOD_UNSPECIFIED;
}

v1::MethodMeasurement::Quantity QuantityMessage(Quantity quantity) {
  switch (quantity) {
    case Quantity::kMeanFreeTime:
      return v1::MethodMeasurement::MEAN_FREE_TIME;
    case Quantity::kIngoingLaw:
      return v1::MethodMeasurement::INGOING_LAW;
    case Quantity::kTrajectory:
      return v1::MethodMeasurement::TRAJECTORY;
    case Quantity::kRelaxationTime:
      return v1::MethodMeasurement::RELAXATION_TIME;
  }
  return v1::MethodMeasurement::QUANTITY_UNSPECIFIED;
}

}  // namespace ballpiston::server
