// The speed of a job and its remaining time, from the snapshots received so far.
//
// Rates are means since the first snapshot of this watch. They start again if a server died and
// lost the work since its last checkpoint. Therefore work before the watch and lost work do not
// distort them. The caller passes the time.
#pragma once

#include <optional>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"

namespace ballpiston::client {

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

}  // namespace ballpiston::client
