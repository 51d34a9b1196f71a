#include "client/output/parameter_text.h"

#include <google/protobuf/descriptor.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace ballpiston::client {

std::string TenDigits(double x) { return absl::StrFormat("%.10g", x); }

std::string ParameterText(const v1::PointParameters& parameters) {
  Cells texts;
  for (const std::string& name : FieldNames(*v1::PointParameters::descriptor())) {
    const std::string value = FieldText(parameters, name, &TenDigits);
    if (!value.empty()) texts.push_back(absl::StrCat(name, " ", value));
  }
  return absl::StrJoin(texts, ", ");
}

Cells ParametersInCsv(const v1::Grid& grid) {
  Cells names = {"rho", "delta", "epsilon", "exponent"};
  for (const std::string name : {"cells", "temperature", "hot", "cold"}) {
    const auto* const list = v1::Grid::descriptor()->FindFieldByName(name);
    if (grid.GetReflection()->FieldSize(grid, list) > 0) names.push_back(name);
  }
  return names;
}

}  // namespace ballpiston::client
