#include "client/output/progress_line.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/output/field_text.h"

namespace ballpiston::client {
namespace {

constexpr size_t kWidestBar = 30;
constexpr size_t kNarrowestBar = 6;

// [####----], `width` characters wide.
std::string Bar(double fraction, size_t width) {
  const size_t inside = width - 2;
  const double filled = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(inside);
  const auto marks = static_cast<size_t>(filled);
  return absl::StrCat("[", std::string(marks, '#'), std::string(inside - marks, '-'), "]");
}

// 1.4e5: shorter than printf's 1.4e+05.
std::string Rate(double rate) {
  return absl::StrCat(
      absl::StrReplaceAll(absl::StrFormat("%.2g", rate), {{"e+0", "e"}, {"e+", "e"}}),
      " samples/s");
}

// Uses the short names of the closed forms: tau_ball_piston for mean_free_time_ball_piston.
std::string Estimate(const v1::Estimate& estimate) {
  const std::optional<double> error = NumberIn(estimate, "standard_error");
  const MeasuredText text = Measured(estimate.value(), error);
  return absl::StrCat(absl::StrReplaceAll(estimate.name(), {{"mean_free_time", "tau"}}), " ",
                      text.value, error ? " +- " : "", text.error);
}

// All but rho, with short names: (delta 0.1 epsilon 0.25 n 1).
std::string Parameters(const v1::PointParameters& parameters) {
  const NumberForm four_digits = [](double x) { return absl::StrFormat("%.4g", x); };
  Cells texts;
  for (const std::string& name : FieldNames(*v1::PointParameters::descriptor())) {
    const std::string value = FieldText(parameters, name, four_digits);
    if (name == "rho" || value.empty()) continue;
    texts.push_back(absl::StrCat(
        absl::StrReplaceAll(name, {{"exponent", "n"}, {"temperature", "T"}}), " ", value));
  }
  return absl::StrCat("(", absl::StrJoin(texts, " "), ")");
}

}  // namespace

double ProgressMeter::FractionOf(const v1::JobProgress& progress) {
  if (progress.has_fraction()) return progress.fraction();
  if (progress.points() == 0) return 0;
  return static_cast<double>(progress.points_done()) / progress.points();
}

void ProgressMeter::Update(const v1::JobProgress& progress, absl::Time now) {
  now_ = {progress, now};
  // Nothing was computed since the first reading: the job waits in the queue, or a server died and
  // lost the samples since its last checkpoint. The means start again.
  const auto work = [](const v1::JobProgress& p) { return std::pair(p.samples(), FractionOf(p)); };
  if (!first_ || work(progress) <= work(first_->progress)) first_ = now_;
}

std::optional<double> ProgressMeter::SamplesPerSecond() const {
  if (!first_ || now_.time <= first_->time) return std::nullopt;
  const double samples = now_.progress.samples() - first_->progress.samples();
  if (samples <= 0) return std::nullopt;
  return samples / absl::ToDoubleSeconds(now_.time - first_->time);
}

std::optional<absl::Duration> ProgressMeter::TimeLeft() const {
  if (!first_) return std::nullopt;
  const double done = Fraction() - FractionOf(first_->progress);
  if (done <= 0) return std::nullopt;
  return (now_.time - first_->time) * ((1 - Fraction()) / done);
}

std::string ProgressLine(const ProgressMeter& meter,
                         const std::optional<v1::PointResult>& point_in_work, size_t width) {
  std::vector<std::string> parts = {
      absl::StrFormat("%d/%d points", meter.progress().points_done(), meter.progress().points())};
  if (const auto rate = meter.SamplesPerSecond()) parts.push_back(Rate(*rate));
  if (const auto left = meter.TimeLeft()) parts.push_back(ClockText(*left) + " left");
  if (point_in_work && !point_in_work->estimates().empty()) {
    parts.push_back(Estimate(point_in_work->estimates(0)));
    parts.push_back(Parameters(point_in_work->parameters()));
  }
  std::string line = parts[0].substr(0, width);
  for (size_t i = 1; i < parts.size(); ++i) {
    if (line.size() + 2 + parts[i].size() > width) break;
    absl::StrAppend(&line, "  ", parts[i]);
  }
  if (line.size() + 1 + kNarrowestBar > width) return line;
  return absl::StrCat(Bar(meter.Fraction(), std::min(width - line.size() - 1, kWidestBar)), " ",
                      line);
}

}  // namespace ballpiston::client
