// Prints a plan: the ladder of models for each point of a specification.
//
//   table   for each point its models, cheapest first, with a mark at the chosen model and the
//           reason for the choice. With more than kMostLadders points: one row per point, with the
//           chosen model. Then the cost of all points.
//   json    the response
//   jsonl   one point per line
//   csv     one row for each point and model:
//           rho,delta,epsilon,exponent,model,chosen,answers,samples,work,relative_statistical_error,
//           relative_model_error,reason; after exponent the other parameters of the specification
//           (parameter_text.h)
//
// Work is in seconds of one core (a table prints the units). Errors are relative. Unknown values
// are empty. In CSV the reason of the chosen model has two parts: why it was chosen and, after a
// semicolon, the source of its error.
#pragma once

#include <ostream>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/spec.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

inline constexpr int kMostLadders = 8;  // for more points a table has one row per point

// `spec` is the planned specification. It sets the heading of a table and the columns of CSV.
void PrintPlan(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan, Format format,
               std::ostream& out);

}  // namespace ballpiston::client
