// The proto's enum values on the command line: FIRST_HIT is first-hit; first_hit is accepted too.
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/generated_enum_reflection.h>

#include <optional>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
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

// All values except UNSPECIFIED.
template <typename Enum>
std::vector<std::string> Spellings() {
  const auto* descriptor = google::protobuf::GetEnumDescriptor<Enum>();
  std::vector<std::string> names;
  for (int i = 0; i < descriptor->value_count(); ++i) {
    if (descriptor->value(i)->number() != 0)
      names.push_back(SpellingOfName(descriptor->value(i)->name()));
  }
  return names;
}

template <typename Enum>
std::optional<Enum> FromSpelling(absl::string_view text) {
  const auto* descriptor = google::protobuf::GetEnumDescriptor<Enum>();
  const std::string wanted = absl::StrReplaceAll(text, {{"_", "-"}});
  for (int i = 0; i < descriptor->value_count(); ++i) {
    const auto* value = descriptor->value(i);
    if (value->number() != 0 && SpellingOfName(value->name()) == wanted) {
      return static_cast<Enum>(value->number());
    }
  }
  return std::nullopt;
}

}  // namespace ballpiston::client
