// Prints the results of a job, point by point, in one of the formats.
//
//   table   a heading with experiment and model, then one row for each point and estimate
//   json    {"client_version": ..., "job": {...}, "points": [...]}, a file::v1::SavedResult;
//           one point per line
//   jsonl   one point per line
//   csv     rho,delta,epsilon,exponent,model,samples,name,value,standard_error,exact,z_score,
//           model_error,noise_floor,limit; after exponent the other parameters of the grid
//           (parameter_text.h)
//   csv-histograms  the same first columns up to samples, then name,sigma,time,lower,upper,count,
//           density,exact_density; one row for each bin
//   csv-curves  the same first columns up to samples, then name,time,position,value,
//           standard_error,limit; one row for each point of a curve
//
// Absent values are empty. A table has the column model only if the points have different models,
// and model_error, noise_floor and limit only if an estimate has the value. Each remark is a line
// below the estimates of its point, and the reasons for the models are below the table
// (model_reasons.h). CSV has no remarks. Tables and csv have neither histograms nor curves. The
// same points give the same bytes: the names of the points, which have the job's id, are left out.
#pragma once

#include <memory>
#include <ostream>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"
#include "client/output/format.h"

namespace ballpiston::client {

class ResultWriter {
 public:
  virtual ~ResultWriter() = default;

  virtual void Begin(const v1::EnsembleJob& job) = 0;
  virtual void Add(const v1::PointResult& point) = 0;
  virtual void End() = 0;  // once, after all points
};

// `out` must outlive the writer.
std::unique_ptr<ResultWriter> NewResultWriter(Format format, std::ostream& out);

// The view to request: it includes histograms and curves if the format shows them.
v1::ListResultsRequest::View ViewFor(Format format);

}  // namespace ballpiston::client
