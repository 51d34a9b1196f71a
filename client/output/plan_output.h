// Prints a plan: the ladder of models for each point of a question.
//
//   table   for each point its ladder, cheapest model first, a mark at the one that would answer,
//   and
//           why; for more than kMostLadders points one row each, of the model that would answer;
//           then the cost of all
//   json    the response
//   jsonl   one point a line
//   csv     a row for each point and model:
//           rho,delta,epsilon,exponent,model,chosen,answers,samples,work,statistical_error,
//           model_error,reason; after exponent the other parameters of the question
//           (parameter_text.h)
//
// Work is in seconds of one core's time (a table gives its units), errors are relative. What is not
// known stays empty. In CSV the chosen model's reason tells first why it is chosen, then, after a
// semicolon, what its error is known from.
#ifndef BALLPISTON_CLIENT_OUTPUT_PLAN_OUTPUT_H_
#define BALLPISTON_CLIENT_OUTPUT_PLAN_OUTPUT_H_

#include <ostream>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/spec.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

inline constexpr int kMostLadders = 8;  // that a table shows in full

// `spec` is what was asked: for a table's heading and the columns of CSV.
void PrintPlan(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan, Format format,
               std::ostream& out);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_PLAN_OUTPUT_H_
