// The speed of a job and its remaining time, and the text of the progress bar's one line.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"

namespace ballpiston::client {

// Measures from the snapshots received so far. Rates are means since this watch saw work begin:
// since the last snapshot that has no more work than the first. They start again if a server died
// and lost the work since its last checkpoint. Therefore time in the queue before the work, work
// before the watch and lost work do not distort them. The caller passes the time.
class ProgressMeter {
 public:
  void Update(const v1::JobProgress& progress, absl::Time now);

  const v1::JobProgress& progress() const { return now_.progress; }
  // The share of the work that is done: predicted by the server, else the share of finished points.
  double Fraction() const { return FractionOf(now_.progress); }
  // Empty until the job has computed samples during the watch.
  std::optional<double> SamplesPerSecond() const;
  std::optional<absl::Duration> TimeLeft() const;

 private:
  struct Reading {
    v1::JobProgress progress;
    absl::Time time;
  };

  static double FractionOf(const v1::JobProgress& progress);

  std::optional<Reading> first_;
  Reading now_;
};

// At most `width` characters. If the text is too long, its last parts are left out. The bar fills
// the rest of the line.
//   [######--------] 12/177 points  1.2e6 samples/s  0:35 left  tau_conditional 21.63 +- 0.12
std::string ProgressLine(const ProgressMeter& meter,
                         const std::optional<v1::PointResult>& point_in_work, size_t width);

}  // namespace ballpiston::client
