// Messages as JSON, one line each, with the proto's field names. Plain fields are printed even if
// they have their default value, so that all messages have the same columns. Doubles read back as
// the same double. 64-bit integers are strings, as in proto JSON. The same message gives the same
// bytes.
#pragma once

#include <google/protobuf/message.h>

#include <ostream>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

std::string Json(const google::protobuf::Message& message);

// INVALID_ARGUMENT, with the parser's message, if the text is not a JSON object, repeats a key,
// or has a field that the message does not have.
absl::Status ReadJson(const std::string& json, google::protobuf::Message& message);

// One message per line.
template <typename Messages>
void PrintJsonLines(const Messages& messages, std::ostream& out) {
  for (const auto& message : messages) out << Json(message) << '\n';
}

// {"key": [...]}, one message per line.
template <typename Messages>
void PrintJsonDocument(absl::string_view key, const Messages& messages, std::ostream& out) {
  out << "{\"" << key << "\": [";
  const char* separator = "\n";
  for (const auto& message : messages) {
    out << separator << Json(message);
    separator = ",\n";
  }
  out << "\n]}\n";
}

}  // namespace ballpiston::client
