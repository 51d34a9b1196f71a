// ballpiston sample: writes the collisions of a point's samples to a file, as CSV or, by the Python
// package, as NumPy arrays.
#include <google/protobuf/descriptor.h>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/command/python.h"
#include "client/command/question.h"
#include "client/output/json.h"
#include "client/output/output_file.h"
#include "client/output/table.h"

namespace ballpiston::client {
namespace {

// A column for each field of the message, a row for each collision. Numbers read back as the same
// double.
void PrintCollisions(const v1::SampleCollisionsResponse& message, std::ostream& out) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int row = 0; row < message.sample_size(); ++row) {
    Cells cells;
    for (int i = 0; i < type.field_count(); ++i) {
      const auto* const field = type.field(i);
      const bool is_number = field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE;
      cells.push_back(is_number ? ExactText(reflection.GetRepeatedDouble(message, field, row))
                                : absl::StrCat(reflection.GetRepeatedUInt64(message, field, row)));
    }
    out << CsvRow(cells);
  }
}

VerbResult WriteCsv(const Connection& connection, const v1::EnsembleSpec& spec,
                    const std::string& path, Terminal& terminal) {
  NewFile file("--out", path);
  file.out() << CsvRow(FieldNames(*v1::SampleCollisionsResponse::descriptor()));
  const absl::Status read =
      connection.client.Sample(spec, [&](const v1::SampleCollisionsResponse& message) {
        PrintCollisions(message, file.out());
        return file.out().good();
      });
  if (!read.ok()) return read;
  if (absl::Status kept = file.Keep(); !kept.ok()) return kept;
  terminal.out << path << '\n';
  return ExitCode::kDone;
}

}  // namespace

VerbResult Sample(const Options& options, Terminal& terminal) {
  const bool is_csv = absl::EndsWith(options.out, ".csv");
  absl::Status bad = CheckTableFile(options.out);
  if (bad.ok() && !is_csv) bad = CheckPythonFor("--out " + options.out);
  if (!bad.ok()) return bad;
  return WithQuestion(
      options, terminal, [&](const Connection& connection, const Options& asked) -> VerbResult {
        if (is_csv) return WriteCsv(connection, asked.spec, options.out, terminal);
        return RunPythonProgram("ballpiston.command", {"sample", options.out, Json(asked.spec)},
                                options, terminal);
      });
}

}  // namespace ballpiston::client
