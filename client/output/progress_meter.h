// How fast a job advances and how long it still takes, from the snapshots seen so far.
//
// Rates are means since the first snapshot of this watch: a job that ran before, or lost the work
// since its last checkpoints with a server, does not distort them. Time is passed in.
#ifndef BALLPISTON_CLIENT_OUTPUT_PROGRESS_METER_H_
#define BALLPISTON_CLIENT_OUTPUT_PROGRESS_METER_H_

#include <optional>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"

namespace ballpiston::client {

class ProgressMeter {
 public:
  void Update(const v1::JobProgress& progress, absl::Time now);

  const v1::JobProgress& progress() const { return now_.progress; }
  // The share of the work done: the server's prediction, else the share of finished points.
  double Fraction() const { return FractionOf(now_.progress); }
  // Empty until something was done during the watch.
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

#endif  // BALLPISTON_CLIENT_OUTPUT_PROGRESS_METER_H_
