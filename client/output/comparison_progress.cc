#include "client/output/comparison_progress.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/output/json.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

// mean-free-time, fixed-step 0.01: 8192 samples in 0.12 s
std::string Text(const v1::MethodMeasurement& measurement) {
  std::string text =
      absl::StrCat(Spelling(measurement.quantity()), ", ", Spelling(measurement.method()));
  if (measurement.time_step() > 0) absl::StrAppendFormat(&text, " %.4g", measurement.time_step());
  absl::StrAppendFormat(&text, ": %d samples in %.3g s", measurement.samples(), measurement.work());
  return text;
}

}  // namespace

ComparisonProgress::~ComparisonProgress() {
  if (drawn_) err_ << '\n' << std::flush;
}

void ComparisonProgress::Begin() {
  if (style_ == ProgressStyle::kBar) Redraw("comparing methods");
}

void ComparisonProgress::OnMeasurement(const v1::MethodMeasurement& measurement) {
  ++measurements_;
  if (style_ == ProgressStyle::kJson) err_ << Json(measurement) << '\n' << std::flush;
  if (style_ == ProgressStyle::kBar) {
    Redraw(absl::StrFormat("%3d measurements  %s", measurements_, Text(measurement)));
  }
}

void ComparisonProgress::Redraw(const std::string& line) {
  err_ << '\r' << line << "\x1b[K" << std::flush;
  drawn_ = true;
}

}  // namespace ballpiston::client
