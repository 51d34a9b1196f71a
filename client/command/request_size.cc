#include "client/command/request_size.h"

#include <google/protobuf/descriptor.h>

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/command/number_list.h"
#include "client/command/violations.h"

namespace ballpiston::client {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

absl::Status TooLarge(absl::string_view path, size_t size, absl::string_view unit, size_t most) {
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": has ", size, " ", unit, "; at most ", most, " are permitted"));
}

void CheckLists(const Message& message, const std::string& path, Violations& violations) {
  std::vector<const FieldDescriptor*> fields;  // those that are set
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    const std::string name = absl::StrCat(path, path.empty() ? "" : ".", field->name());
    if (field->is_repeated()) {
      const int size = message.GetReflection()->FieldSize(message, field);
      if (size > kMaxListLength) {
        violations.Add(TooLarge(name, static_cast<size_t>(size), "values", kMaxListLength));
      }
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      CheckLists(message.GetReflection()->GetMessage(message, field), name, violations);
    }
  }
}

}  // namespace

absl::Status CheckSize(const Message& message, const std::string& path) {
  Violations violations;
  CheckLists(message, path, violations);
  if (absl::Status lists = violations.Lines(); !lists.ok()) return lists;
  const size_t bytes = message.ByteSizeLong();
  if (bytes <= kMaxRequestBytes) return absl::OkStatus();
  return TooLarge(path.empty() ? "the request" : path, bytes, "bytes", kMaxRequestBytes);
}

}  // namespace ballpiston::client
