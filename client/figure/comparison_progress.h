// Tells on standard error how a comparison of methods gets on, in the styles of
// progress_reporter.h: one line, redrawn; each measurement as the program printed it; or nothing.
#ifndef BALLPISTON_CLIENT_FIGURE_COMPARISON_PROGRESS_H_
#define BALLPISTON_CLIENT_FIGURE_COMPARISON_PROGRESS_H_

#include <ostream>
#include <string>

#include "client/figure/method_measurement.h"
#include "client/output/progress_reporter.h"

namespace ballpiston::client {

// `err` has to outlive it.
class ComparisonProgress {
 public:
  ComparisonProgress(ProgressStyle style, std::ostream& err) : style_(style), err_(err) {}
  ~ComparisonProgress();  // ends the line
  ComparisonProgress(const ComparisonProgress&) = delete;
  ComparisonProgress& operator=(const ComparisonProgress&) = delete;

  // `line` is the program's, with its end.
  void OnMeasurement(const MethodMeasurement& measurement, const std::string& line);

 private:
  const ProgressStyle style_;
  std::ostream& err_;
  int measurements_ = 0;
  bool drawn_ = false;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_COMPARISON_PROGRESS_H_
