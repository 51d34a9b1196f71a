#include <google/protobuf/descriptor.h>

#include "core/statistics/stated_error.h"
#include "tests/questions/checks.h"

namespace ballpiston::questions {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

void Check(const std::string& name, const std::optional<double>& value, Findings& findings) {
  if (value && !std::isfinite(*value)) {
    findings.push_back({kFiniteCheck, absl::StrCat(name, " is ", *value)});
  }
}

void CheckNumbers(const Message& message, const std::string& path, Findings& findings) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    const std::string name = absl::StrCat(path, path.empty() ? "" : ".", field->name());
    const int size = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
    for (int i = 0; i < size; ++i) {
      if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
        CheckNumbers(field->is_repeated() ? reflection.GetRepeatedMessage(message, field, i)
                                          : reflection.GetMessage(message, field),
                     name, findings);
      } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
        Check(name,
              field->is_repeated() ? reflection.GetRepeatedDouble(message, field, i)
                                   : reflection.GetDouble(message, field),
              findings);
      }
    }
  }
}

void CheckEstimate(const Estimate& estimate, Findings& findings) {
  Check(estimate.name, estimate.value, findings);
  Check(estimate.name + ", standard error", estimate.standard_error, findings);
  Check(estimate.name + ", exact", estimate.exact, findings);
  Check(estimate.name + ", limit", estimate.limit, findings);
  Check(estimate.name + ", noise floor", estimate.noise_floor, findings);
}

void CheckCurve(const Curve& curve, Findings& findings) {
  for (const CurvePoint& point : curve.points) {
    Check(curve.name + ", at", point.at, findings);
    Check(absl::StrCat(curve.name, " at ", point.at), point.value, findings);
    Check(absl::StrCat(curve.name, " at ", point.at, ", error"), point.standard_error, findings);
    Check(absl::StrCat(curve.name, " at ", point.at, ", limit"), point.limit, findings);
  }
}

void CheckDivergence(const KlDivergence& divergence, Findings& findings) {
  Check("relative entropy", divergence.value, findings);
  Check("relative entropy, noise floor", divergence.noise_floor, findings);
  Check("relative entropy, noise error", divergence.noise_error, findings);
  Check("relative entropy, error", divergence.standard_error, findings);
}

}  // namespace

Findings CheckFinite(const Message& message) {
  Findings findings;
  CheckNumbers(message, "", findings);
  return findings;
}

Findings CheckFinite(const PointSummary& summary) {
  Findings findings;
  for (const Estimate& estimate : summary.estimates) {
    // A small sample may contain nothing that determines the value.
    const bool is_small = !HasStatedError(static_cast<double>(summary.samples));
    if (is_small && std::isnan(estimate.value)) continue;
    CheckEstimate(estimate, findings);
  }
  for (const Curve& curve : summary.curves) CheckCurve(curve, findings);
  if (summary.kl_divergence) CheckDivergence(*summary.kl_divergence, findings);
  for (const NamedHistogram& named : summary.histograms) {
    Check(named.name + ", lower", named.histogram.lower, findings);
    Check(named.name + ", upper", named.histogram.upper, findings);
    Check(named.name + ", time", named.time, findings);
  }
  Check("energy error", summary.health.max_energy_error, findings);
  return findings;
}

}  // namespace ballpiston::questions
