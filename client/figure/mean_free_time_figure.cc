#include "client/figure/mean_free_time_figure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "client/figure/mean_free_time_script.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

constexpr char kConditionalTime[] = "mean_free_time_conditional";
constexpr char kMeanFreeTimeBallPiston[] = "mean_free_time_ball_piston";
constexpr int kCurvePoints = 200;

// The inset has few points, and its collisions are correlated: it can afford more of them.
constexpr int64_t kCollisionsPerSample = 10;

const v1::Estimate* Find(const v1::PointResult& point, absl::string_view name) {
  for (const v1::Estimate& estimate : point.estimates()) {
    if (estimate.name() == name) return &estimate;
  }
  return nullptr;
}

absl::Status Lacking(absl::string_view what) {
  return absl::InternalError(absl::StrCat("the server's answer lacks ", what));
}

std::string Row(const std::vector<std::string>& cells) {
  return absl::StrCat(absl::StrJoin(cells, ","), "\n");
}

std::string ErrorText(const v1::Estimate& estimate) {
  return estimate.has_standard_error() ? ExactText(estimate.standard_error()) : "";
}
std::string ExactValueText(const v1::Estimate& estimate) {
  return estimate.has_exact() ? ExactText(estimate.exact()) : "";
}
std::string ZText(const v1::Estimate& estimate) {
  return estimate.has_z_score() ? ExactText(estimate.z_score()) : "";
}

// scale/time with the relative error of the time: cells "rate" and "rate error".
std::pair<std::string, std::string> RateTexts(double scale, const v1::Estimate& time) {
  const double rate = scale / time.value();
  return {ExactText(rate),
          time.has_standard_error() ? ExactText(rate * time.standard_error() / time.value()) : ""};
}

absl::StatusOr<std::string> MeasuredCsv(const MeanFreeTimeAnswers& answers) {
  std::map<double, double> mean_free_time;  // by delta
  for (const auto& pair : answers.scale.points()) {
    mean_free_time[pair.delta()] = pair.tau_ball_piston();
  }
  std::string csv =
      "rho,delta,epsilon,samples,mean_free_time_conditional,standard_error,exact,z_score,"
      "scaled_rate,scaled_rate_error\n";
  for (const v1::PointResult& point : answers.conditional) {
    const v1::Estimate* time = Find(point, kConditionalTime);
    const auto scale = mean_free_time.find(point.parameters().delta());
    if (time == nullptr) return Lacking(kConditionalTime);
    if (scale == mean_free_time.end()) return Lacking("the closed form at a delta");
    const auto [rate, rate_error] = RateTexts(scale->second, *time);
    absl::StrAppend(
        &csv, Row({ExactText(point.parameters().rho()), ExactText(point.parameters().delta()),
                   ExactText(point.parameters().epsilon()), ExactText(point.samples()),
                   ExactText(time->value()), ErrorText(*time), ExactValueText(*time), ZText(*time),
                   rate, rate_error}));
  }
  return csv;
}

absl::StatusOr<std::string> InsetCsv(const MeanFreeTimeAnswers& answers) {
  std::string csv =
      "rho,delta,collisions,mean_free_time_ball_piston,standard_error,exact,z_score,rate,"
      "rate_error\n";
  for (const v1::PointResult& point : answers.equilibrium) {
    const v1::Estimate* time = Find(point, kMeanFreeTimeBallPiston);
    if (time == nullptr) return Lacking(kMeanFreeTimeBallPiston);
    const auto [rate, rate_error] = RateTexts(1, *time);
    absl::StrAppend(&csv,
                    Row({ExactText(point.parameters().rho()), ExactText(point.parameters().delta()),
                         ExactText(point.samples()), ExactText(time->value()), ErrorText(*time),
                         ExactValueText(*time), ZText(*time), rate, rate_error}));
  }
  return csv;
}

absl::StatusOr<std::string> ExactCsv(const MeanFreeTimeAnswers& answers) {
  if (answers.scale.points().empty()) return Lacking("phi");
  std::string csv = "curve,x,y\n";
  for (const auto& energy : answers.scale.points(0).energies()) {
    absl::StrAppend(&csv, Row({"phi", ExactText(energy.epsilon()), ExactText(energy.phi())}));
  }
  for (const auto& pair : answers.curve.points()) {
    absl::StrAppend(&csv,
                    Row({"rate", ExactText(pair.delta()), ExactText(1 / pair.tau_ball_piston())}));
  }
  return csv;
}

// The billiard by name: left to choose, the service would answer with the closed form that the
// figure is to test.
v1::EnsembleSpec CommonSpec(const MeanFreeTimeQuestion& question) {
  v1::EnsembleSpec spec;
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.mutable_grid()->add_rho(question.rho);
  spec.mutable_grid()->mutable_delta()->Add(question.delta.begin(), question.delta.end());
  spec.set_seed(question.seed);
  return spec;
}

void Take(const std::vector<v1::PointResult>& points, LargestZ& largest) {
  for (const v1::PointResult& point : points) {
    for (const v1::Estimate& estimate : point.estimates()) {
      if (!estimate.has_z_score()) continue;
      largest.value = std::max(largest.value, std::abs(estimate.z_score()));
      ++largest.estimates;
    }
  }
}

}  // namespace

std::vector<double> PaperEnergies() {
  std::vector<double> energies;
  for (int i = 1; i <= 49; ++i) energies.push_back(i / 100.0);
  for (const double divisor : {200.0, 400.0, 800.0, 1600.0, 3200.0}) {
    energies.push_back(1 / divisor);
    energies.push_back(0.5 - 1 / divisor);
  }
  std::sort(energies.begin(), energies.end());
  return energies;
}

v1::EnsembleSpec ConditionalSpec(const MeanFreeTimeQuestion& question) {
  v1::EnsembleSpec spec = CommonSpec(question);
  spec.set_experiment(v1::EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME);
  const std::vector<double> energies = PaperEnergies();
  spec.mutable_grid()->mutable_epsilon()->Add(energies.begin(), energies.end());
  spec.mutable_target()->set_samples(question.samples);
  return spec;
}

v1::EnsembleSpec EquilibriumSpec(const MeanFreeTimeQuestion& question) {
  v1::EnsembleSpec spec = CommonSpec(question);
  spec.set_experiment(v1::EnsembleSpec::EQUILIBRIUM);
  spec.mutable_target()->set_collisions(kCollisionsPerSample * question.samples);
  return spec;
}

v1::EvaluatePairsRequest ScaleRequest(const MeanFreeTimeQuestion& question) {
  v1::EvaluatePairsRequest request;
  request.add_rho(question.rho);
  request.mutable_delta()->Add(question.delta.begin(), question.delta.end());
  for (int i = 0; i <= kCurvePoints; ++i) request.add_epsilon(0.5 * i / kCurvePoints);
  return request;
}

v1::EvaluatePairsRequest CurveRequest(const MeanFreeTimeQuestion& question, double delta_bound) {
  const auto [smallest, largest] =
      std::minmax_element(question.delta.begin(), question.delta.end());
  const double from = *smallest / 2;
  const double to = std::min(2 * *largest, delta_bound);
  v1::EvaluatePairsRequest request;
  request.add_rho(question.rho);
  for (int i = 0; i < kCurvePoints; ++i) {
    request.add_delta(from * std::pow(to / from, static_cast<double>(i) / kCurvePoints));
  }
  request.add_delta(to);
  return request;
}

absl::StatusOr<MeanFreeTimeFiles> MakeFiles(const MeanFreeTimeQuestion& question,
                                            const MeanFreeTimeAnswers& answers) {
  absl::StatusOr<std::string> measured = MeasuredCsv(answers);
  if (!measured.ok()) return measured.status();
  absl::StatusOr<std::string> inset = InsetCsv(answers);
  if (!inset.ok()) return inset.status();
  absl::StatusOr<std::string> exact = ExactCsv(answers);
  if (!exact.ok()) return exact.status();
  return MeanFreeTimeFiles{.measured_csv = *std::move(measured),
                           .inset_csv = *std::move(inset),
                           .exact_csv = *std::move(exact),
                           .script = MeanFreeTimeScript(question.delta)};
}

LargestZ LargestDeviation(const MeanFreeTimeAnswers& answers) {
  LargestZ largest;
  Take(answers.conditional, largest);
  Take(answers.equilibrium, largest);
  return largest;
}

}  // namespace ballpiston::client
