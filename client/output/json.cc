#include "client/output/json.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "client/library/quoted.h"

namespace ballpiston::client {

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
  google::protobuf::Struct keys;
  const auto read = google::protobuf::util::JsonStringToMessage(json, &keys);
  const size_t repeated = read.message().find("Repeated map key: ");
  if (repeated != std::string::npos) {
    return absl::InvalidArgumentError(
        Shortened(read.message().substr(repeated).ToString(), kLongestMessage));
  }
  const auto status = google::protobuf::util::JsonStringToMessage(json, &message);
  if (status.ok()) return absl::OkStatus();
  // The parser's message contains the wrong value in full, even if it is very long.
  return absl::InvalidArgumentError(Shortened(std::string(status.message()), kLongestMessage));
}

}  // namespace ballpiston::client
