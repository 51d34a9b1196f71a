#include "client/output/json.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

// The path, such as grid.rho, of a list that contains null or a list. The parser drops a null from
// a list, and merges a list in a list with it. Both would move the values behind it to other
// points.
std::optional<std::string> ListThatMoves(const google::protobuf::Value& value) {
  for (const auto& [key, field] : value.struct_value().fields()) {
    const auto inner = ListThatMoves(field);
    if (inner) return absl::StrCat(key, inner->empty() ? "" : ".", *inner);
  }
  for (const google::protobuf::Value& item : value.list_value().values()) {
    if (item.has_null_value() || item.has_list_value()) return "";
    if (auto inner = ListThatMoves(item)) return inner;
  }
  return std::nullopt;
}

// The parser's message contains the wrong value in full, even if it is very long. Control
// characters would change the terminal.
absl::Status ParserError(absl::string_view message) {
  std::string text = Shortened(message, kLongestMessage);
  std::erase_if(text, [](char c) { return absl::ascii_iscntrl(c) && c != '\n'; });
  return absl::InvalidArgumentError(text);
}

}  // namespace

std::string Json(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text, options);
  return status.ok() ? text : "null";
}

absl::Status ReadJson(const std::string& json, google::protobuf::Message& message) {
  // The parser accepts `null` and a bare string as an empty message.
  if (!absl::StartsWith(absl::StripLeadingAsciiWhitespace(json), "{")) {
    return absl::InvalidArgumentError("not a JSON object");
  }
  // The parser takes the last value of a repeated field. It rejects only repeated keys of a map, so
  // the text is also parsed as a map.
  google::protobuf::Value keys;
  const auto read = google::protobuf::util::JsonStringToMessage(json, &keys);
  const size_t repeated = read.message().find("Repeated map key: ");
  if (repeated != std::string::npos) {
    return ParserError(read.message().substr(repeated).ToString());
  }
  if (const auto list = ListThatMoves(keys)) {
    return ParserError(
        absl::StrCat(*list, ": its list contains null or a list; permitted: numbers or texts"));
  }
  const auto status = google::protobuf::util::JsonStringToMessage(json, &message);
  return status.ok() ? absl::OkStatus() : ParserError(std::string(status.message()));
}

}  // namespace ballpiston::client
