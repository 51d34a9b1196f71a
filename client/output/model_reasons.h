// Prints, below a table, the reason why each model was chosen. Each reason is printed once, even if
// several points share it.
//
//   closed-form: exact                                          one reason for all points
//
//   markov (rho 0.53, delta 0.0125): off by 1.2e-03             several reasons: each with its
//   billiard (rho 0.53, delta 0.1 and 2 more points): ...       first point
#pragma once

#include <map>
#include <ostream>
#include <string>
#include <utility>

#include "ballpiston/v1/spec.pb.h"
#include "client/output/field_text.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"

namespace ballpiston::client {

// The model's name on the command line; "none" if no model can be used.
inline std::string ModelName(v1::EnsembleSpec::Model model) {
  return model == v1::EnsembleSpec::MODEL_UNSPECIFIED ? "none" : Spelling(model);
}

// In the order of their first points. `points` are PointResults or PointPlans; one without a reason
// has the model that the user chose.
template <typename Points>
void PrintModelReasons(const Points& points, std::ostream& out) {
  std::map<std::pair<std::string, std::string>, int> counts;  // of points, by model and reason
  for (const auto& point : points) {
    if (!point.reason().empty()) ++counts[{ModelName(point.model()), point.reason()}];
  }
  const bool is_only = counts.size() == 1;
  for (const auto& point : points) {
    const auto first = counts.extract({ModelName(point.model()), point.reason()});
    if (first.empty()) continue;  // printed already, or no reason
    out << first.key().first;
    if (!is_only) {
      const int others = first.mapped() - 1;
      out << " (" << ParameterText(point.parameters())
          << (others > 0 ? " and " + Counted(others, "more point") : "") << ")";
    }
    out << ": " << point.reason() << '\n';
  }
}

}  // namespace ballpiston::client
