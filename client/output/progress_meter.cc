#include "client/output/progress_meter.h"

namespace ballpiston::client {

double ProgressMeter::FractionOf(const v1::JobProgress& progress) {
  if (progress.has_fraction()) return progress.fraction();
  if (progress.points() == 0) return 0;
  return static_cast<double>(progress.points_done()) / progress.points();
}

void ProgressMeter::Update(const v1::JobProgress& progress, absl::Time now) {
  now_ = {progress, now};
  // Fewer samples than at first: a server died and lost the samples since its last checkpoint. The
  // means start again.
  if (!first_ || progress.samples() < first_->progress.samples()) first_ = now_;
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

}  // namespace ballpiston::client
