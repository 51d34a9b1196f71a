// Prints the results and the plans of the points of a specification, in one of the formats.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"
#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// The formats of all output.
enum class Format {
  kTable,  // aligned text, with as many digits as the standard error supports
  kJson,   // one document of proto JSON with the proto's field names
  kJsonl,  // one JSON object per line and point
  kCsv     // a header, then one row for each point and estimate
};

// JSON shows the grids of jobs, and histograms and curves of points; the other formats do not.
inline bool IsJson(Format format) { return format == Format::kJson || format == Format::kJsonl; }

// Prints the results of a job, point by point.
//
//   table   a heading with experiment and model, then one row for each point and estimate
//   json    {"client_version": ..., "job": {...}, "points": [...]}, a file::v1::SavedResult;
//           one point per line
//   jsonl   one point per line
//   csv     rho,delta,epsilon,exponent,model,samples,name,value,standard_error,exact,z_score,
//           model_error,noise_floor,limit; after exponent the other parameters of the grid
//           (table.h)
//
// Absent values are empty. A table has the column model only if the points have different models,
// and model_error, noise_floor and limit only if an estimate has the value. Each remark is a line
// below the estimates of its point. Below the table are the reasons for the models. CSV has no
// remarks. Tables and CSV have neither histograms nor curves.
class ResultWriter {
 public:
  // `out` must outlive the writer. A file carries the job's name, its specification with the seed,
  // and the versions of engine and client: as CSV it has them in two more lines, which begin with
  // #.
  ResultWriter(Format format, std::ostream& out, bool is_file = false)
      : format_(format), out_(out), is_file_(is_file) {}

  void Begin(const v1::EnsembleJob& job);
  void Add(const v1::PointResult& point);
  void End();  // once, after all points

 private:
  const Format format_;
  std::ostream& out_;
  const bool is_file_;
  v1::EnsembleJob job_;
  std::vector<std::string> parameters_;  // the first columns of CSV
  std::vector<v1::PointResult> points_;  // of a table: the last one may widen its columns
  const char* separator_ = "\n";         // of points in the JSON document
};

// The ladder of models for each point of a specification, which sets the heading of the table and
// the columns of CSV.
//
//   table   for each point its models, cheapest first, with a mark at the chosen model and the
//           reason for the choice. With more than kMostLadders points: one row per point, with the
//           chosen model. Then the cost of all points.
//   json    the response
//   jsonl   one point per line
//   csv     one row for each point and model:
//           rho,delta,epsilon,exponent,model,chosen,answers,samples,work,relative_statistical_error,
//           relative_model_error,reason; after exponent the other parameters of the specification
//           (table.h)
//
// Work is in seconds of one core (a table prints the units). Errors are relative. Unknown values
// are empty. In CSV the reason of the chosen model has two parts: why it was chosen and, after a
// semicolon, the source of its error.
inline constexpr int kMostLadders = 8;
void PrintPlan(const v1::EnsembleSpec& spec, const v1::PlanEnsembleJobResponse& plan, Format format,
               std::ostream& out);

}  // namespace ballpiston::client
