// The fields of messages as text, by their names in the proto: the cells of CSV and of tables.
#pragma once

#include <google/protobuf/message.h>

#include <optional>
#include <string>
#include <vector>

#include "client/output/number_text.h"

namespace ballpiston::client {

using Cells = std::vector<std::string>;
using NumberForm = std::string (*)(double);

// `path`: the field's name, or names with dots between, as in progress.points_done. An enum value
// is written as on the command line, a time as 2026-01-31T12:00:00Z. Empty if the message lacks the
// field.
std::string FieldText(const google::protobuf::Message& message, const std::string& path,
                      NumberForm form = &ExactText);

Cells FieldTexts(const google::protobuf::Message& message, const Cells& paths,
                 NumberForm form = &ExactText);

// The number in an optional field.
std::optional<double> NumberIn(const google::protobuf::Message& message, const std::string& field);

// The names of all fields in the proto's order.
Cells FieldNames(const google::protobuf::Descriptor& type);

Cells Joined(Cells cells, const Cells& more);

}  // namespace ballpiston::client
