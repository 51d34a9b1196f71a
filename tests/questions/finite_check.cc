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

}  // namespace

Findings CheckFinite(const Message& message) {
  Findings findings;
  CheckNumbers(message, "", findings);
  return findings;
}

Findings CheckFinite(const PointSummary& summary) {
  Findings findings;
  const auto check = [&](const std::string& name,
                         const std::vector<std::pair<const char*, std::optional<double>>>& parts) {
    for (const auto& [part, value] : parts) Check(absl::StrCat(name, part), value, findings);
  };
  // A small sample may contain nothing that determines a value.
  const bool is_small = !HasStatedError(static_cast<double>(summary.samples));
  for (const Estimate& of : summary.estimates) {
    if (is_small && std::isnan(of.value)) continue;
    check(of.name, {{"", of.value},
                    {", standard error", of.standard_error},
                    {", exact", of.exact},
                    {", limit", of.limit},
                    {", noise floor", of.noise_floor}});
  }
  for (const Curve& curve : summary.curves) {
    for (const CurvePoint& of : curve.points) {
      check(absl::StrCat(curve.name, " at ", of.at), {{", place", of.at},
                                                      {"", of.value},
                                                      {", error", of.standard_error},
                                                      {", limit", of.limit}});
    }
  }
  if (const auto& of = summary.kl_divergence) {
    check("relative entropy", {{"", of->value},
                               {", noise floor", of->noise_floor},
                               {", noise error", of->noise_error},
                               {", error", of->standard_error}});
  }
  for (const NamedHistogram& of : summary.histograms) {
    check(of.name,
          {{", lower", of.histogram.lower}, {", upper", of.histogram.upper}, {", time", of.time}});
  }
  check("energy error", {{"", summary.health.max_energy_error}});
  return findings;
}

}  // namespace ballpiston::questions
