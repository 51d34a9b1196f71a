// The progress of a watched job: its speed, its line, its report on standard error.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <ostream>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "ballpiston/file/v1/progress.pb.h"
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

enum class ProgressStyle { kAuto, kBar, kJson, kNone };

// Standard error is a terminal that has colours and can draw over a line.
bool HasTerminal();

// Shows the progress of a watched job on standard error.
//
//   bar   one line, redrawn: bar, points, samples per second, time left, and the current
//         estimate of the point that changed last
//   json  one file.v1.WatchProgress per line, with the points that changed: the unfinished
//         points first, then the finished points; within each group the newest first
//   none  only notes
//
// Thread-safe: the thread that handles Ctrl-C calls Farewell while another thread redraws the bar.
class ProgressReporter {
 public:
  // kAuto is kBar if HasTerminal(), else kNone. `name` is the job's name. `err` must
  // outlive the reporter.
  ProgressReporter(ProgressStyle style, std::ostream& err, absl::string_view name);

  void OnJob(const v1::EnsembleJob& job);
  void OnSnapshot(const v1::StatisticsSnapshot& snapshot);
  void OnDisconnect(const absl::Status& why, absl::Duration pause);
  void OnEnd();  // the watch is over; only notes follow
  // Lines for the user that are not progress; every style shows them.
  void Note(absl::string_view text);
  // Clears the bar and prints the last message before the program ends. The bar is not drawn again.
  void Farewell(absl::string_view text);

 private:
  void Show(const v1::StatisticsSnapshot& changes);
  void WriteJson(const v1::StatisticsSnapshot& changes, absl::string_view note);
  void WriteLines(absl::string_view text);

  const ProgressStyle style_;
  std::ostream& err_;
  std::timed_mutex mutex_;
  v1::EnsembleJob job_;
  bool named_ = false;  // the first OnJob has run
  bool drawn_ = false;  // the cursor is at the end of a line that must be cleared
  ProgressMeter meter_;
  std::optional<v1::PointResult> point_;
};

}  // namespace ballpiston::client
