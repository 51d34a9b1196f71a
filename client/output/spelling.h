// The proto's enum values on the command line: FIRST_HIT is first-hit; first_hit is accepted too.
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/generated_enum_reflection.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

inline std::string SpellingOfName(absl::string_view enum_name) {
  return absl::StrReplaceAll(absl::AsciiStrToLower(enum_name), {{"_", "-"}});
}

// A value that this version does not know is printed as its number.
inline std::string Spelling(const google::protobuf::EnumDescriptor& type, int number) {
  const auto* value = type.FindValueByNumber(number);
  return value == nullptr ? std::to_string(number) : SpellingOfName(value->name());
}

template <typename Enum>
std::string Spelling(Enum value) {
  return Spelling(*google::protobuf::GetEnumDescriptor<Enum>(), value);
}

// The spellings and the values of all but UNSPECIFIED.
template <typename Enum>
std::vector<std::pair<std::string, Enum>> EnumChoices() {
  const auto* type = google::protobuf::GetEnumDescriptor<Enum>();
  std::vector<std::pair<std::string, Enum>> choices;
  for (int i = 0; i < type->value_count(); ++i) {
    const auto* value = type->value(i);
    if (value->number() == 0) continue;
    choices.emplace_back(SpellingOfName(value->name()), static_cast<Enum>(value->number()));
  }
  return choices;
}

}  // namespace ballpiston::client
