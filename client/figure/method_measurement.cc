#include "client/figure/method_measurement.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include "absl/strings/str_cat.h"

namespace ballpiston::client {

absl::StatusOr<MethodMeasurement> ParseMeasurement(const std::string& line) {
  google::protobuf::Struct object;
  bool complete = google::protobuf::util::JsonStringToMessage(line, &object).ok();
  const auto field = [&](const char* name) -> const google::protobuf::Value& {
    complete = complete && object.fields().contains(name);
    return (*object.mutable_fields())[name];
  };
  const auto text = [&](const char* name) { return field(name).string_value(); };
  const auto number = [&](const char* name) { return field(name).number_value(); };
  const auto count = [&](const char* name) { return static_cast<uint64_t>(number(name)); };
  const MethodMeasurement measurement = {.method = text("method"),
                                         .time_step = number("time_step"),
                                         .quantity = text("quantity"),
                                         .delta = number("delta"),
                                         .samples = count("samples"),
                                         .wall_hits = count("wall_hits"),
                                         .work = number("work_seconds"),
                                         .value = number("value"),
                                         .statistical_error = number("statistical_error")};
  if (complete) return measurement;
  return absl::InternalError(absl::StrCat("method_comparison printed no measurement: ", line));
}

}  // namespace ballpiston::client
