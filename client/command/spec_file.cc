#include "client/command/spec_file.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/reflection.h>

#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/output/json.h"

namespace ballpiston::client {
namespace {

// The parser reads -0 as the integer 0, without a sign, but keeps the sign of -0.0. Without the
// sign a specification stays the same when it is printed and read again.
void DropSignsOfZeros(google::protobuf::Message& message) {
  using google::protobuf::FieldDescriptor;
  const google::protobuf::Reflection& values = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  values.ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      DropSignsOfZeros(*values.MutableMessage(&message, field));
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE && !field->is_repeated()) {
      values.SetDouble(&message, field, values.GetDouble(message, field) + 0.0);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
      const auto list = values.GetMutableRepeatedFieldRef<double>(&message, field);
      for (int i = 0; i < list.size(); ++i) list.Set(i, list.Get(i) + 0.0);
    }
  }
}

}  // namespace

absl::StatusOr<v1::EnsembleSpec> ParseSpec(absl::string_view name, const std::string& json) {
  v1::EnsembleSpec spec;
  if (absl::Status bad = ReadJson(json, spec); !bad.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--spec ", name, ": ", bad.message()));
  }
  DropSignsOfZeros(spec);
  return spec;
}

}  // namespace ballpiston::client
