#include "client/figure/comparison_progress.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston::client {
namespace {

// mean-free-time, fixed-step 0.01: 8192 samples in 0.12 s
std::string Text(const MethodMeasurement& measurement) {
  std::string text = absl::StrCat(measurement.quantity, ", ", measurement.method);
  if (measurement.time_step > 0) absl::StrAppendFormat(&text, " %.4g", measurement.time_step);
  absl::StrAppendFormat(&text, ": %d samples in %.3g s", measurement.samples, measurement.work);
  return text;
}

}  // namespace

ComparisonProgress::~ComparisonProgress() {
  if (drawn_) err_ << '\n' << std::flush;
}

void ComparisonProgress::OnMeasurement(const MethodMeasurement& measurement,
                                       const std::string& line) {
  ++measurements_;
  if (style_ == ProgressStyle::kJson) err_ << line << std::flush;
  if (style_ != ProgressStyle::kBar) return;
  err_ << absl::StrFormat("\r%3d measurements  %s\x1b[K", measurements_, Text(measurement))
       << std::flush;
  drawn_ = true;
}

}  // namespace ballpiston::client
