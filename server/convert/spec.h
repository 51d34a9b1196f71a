// Converts between the API's EnsembleSpec and the core's. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "core/gas/gas_shape.h"

namespace ballpiston::server {

struct CheckedSpec {
  EnsembleSpec spec;                       // can be run if there are no violations
  std::vector<FieldViolation> violations;  // paths begin with "spec."
};

// The message's specification and all its violations. A field or an enumeration value that this
// version does not know is a violation, because it might change the answer.
CheckedSpec CheckSpec(const v1::EnsembleSpec& message);

// Adds a violation of `path` for each field that this version does not know, at most 100.
void AddUnknownFields(const char* path, const google::protobuf::Message& message,
                      std::vector<FieldViolation>& violations);

// Adds violations that were found in checked.spec.
void AddViolations(std::vector<FieldViolation> found, CheckedSpec& checked);

// Gives equal questions equal lists: writes the experiment's default values into empty lists of the
// grid, 0 for -0, and shapes in one form.
void Normalize(v1::EnsembleSpec& message);

// Parses the name of a shape. INVALID_ARGUMENT quotes at most the beginning of the text.
absl::StatusOr<GasShape> ShapeOfText(const std::string& text);

// The value of `cells` must be the code of a shape.
v1::PointParameters ParametersMessage(const PointParameters& parameters);
// Leaves out `cells` if the text is not the name of a shape.
PointParameters ParametersOf(const v1::PointParameters& message);
v1::EnsembleSpec::Model ModelMessage(Model model);

// The same bytes for the same question: default values are left out, and the names of a table's
// columns are sorted.
std::string QuestionBytes(v1::EnsembleSpec message);

}  // namespace ballpiston::server
