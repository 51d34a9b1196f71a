// Tells on standard error how a comparison of methods gets on, in the styles of
// progress_reporter.h: one line, redrawn; one object a line, the measurement; or nothing.
#ifndef BALLPISTON_CLIENT_OUTPUT_COMPARISON_PROGRESS_H_
#define BALLPISTON_CLIENT_OUTPUT_COMPARISON_PROGRESS_H_

#include <ostream>
#include <string>

#include "ballpiston/v1/method.pb.h"
#include "client/output/progress_reporter.h"

namespace ballpiston::client {

// `err` has to outlive it.
class ComparisonProgress {
 public:
  ComparisonProgress(ProgressStyle style, std::ostream& err) : style_(style), err_(err) {}
  ~ComparisonProgress();  // ends the line
  ComparisonProgress(const ComparisonProgress&) = delete;
  ComparisonProgress& operator=(const ComparisonProgress&) = delete;

  void Begin();
  void OnMeasurement(const v1::MethodMeasurement& measurement);

 private:
  void Redraw(const std::string& line);

  const ProgressStyle style_;
  std::ostream& err_;
  int measurements_ = 0;
  bool drawn_ = false;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_COMPARISON_PROGRESS_H_
