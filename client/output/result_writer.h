// Prints the results of a job, point by point, in one of the formats.
//
//   table   a heading with experiment and model, then one row for each point and estimate
//   json    {"client_version": ..., "job": {...}, "points": [...]}, a file::v1::SavedResult;
//           one point per line
//   jsonl   one point per line
//   csv     rho,delta,epsilon,exponent,model,samples,name,value,standard_error,exact,z_score,
//           model_error,noise_floor,limit; after exponent the other parameters of the grid
//           (field_text.h)
//
// Absent values are empty. A table has the column model only if the points have different models,
// and model_error, noise_floor and limit only if an estimate has the value. Each remark is a line
// below the estimates of its point, and the reasons for the models are below the table
// (model_reasons.h). CSV has no remarks. Tables and CSV have neither histograms nor curves.
#pragma once

#include <memory>
#include <ostream>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"

namespace ballpiston::client {

// The formats of all output.
enum class Format {
  kTable,  // aligned text, with as many digits as the standard error supports
  kJson,   // one document of proto JSON with the proto's field names
  kJsonl,  // one JSON object per line and point
  kCsv     // a header, then one row for each point and estimate
};

class ResultWriter {
 public:
  virtual ~ResultWriter() = default;

  virtual void Begin(const v1::EnsembleJob& job) = 0;
  virtual void Add(const v1::PointResult& point) = 0;
  virtual void End() = 0;  // once, after all points
};

// `out` must outlive the writer. A file carries the job's name, its specification with the seed,
// and the versions of engine and client: as CSV it has them in two more lines, which begin with #.
std::unique_ptr<ResultWriter> NewResultWriter(Format format, std::ostream& out,
                                              bool is_file = false);

// JSON shows the grids of jobs, and histograms and curves of points; the other formats do not.
inline bool IsJson(Format format) { return format == Format::kJson || format == Format::kJsonl; }

}  // namespace ballpiston::client
