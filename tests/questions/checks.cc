#include "tests/questions/checks.h"

#include "absl/strings/ascii.h"
#include "core/model_choice/ladder.h"
#include "core/statistics/stated_error.h"
#include "tests/support/process.h"

namespace ballpiston::questions {
namespace {

// The server refuses more than kMostSeconds at nominal speed. A plan has the measured speed, which
// is a hundred times lower under a sanitizer on a busy machine.
constexpr double kMostPlannedSeconds = 1e4 * kMostSeconds;

#ifdef BALLPISTON_SANITIZED
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

double BytesOf(const std::string& line) { return 1024 * 1024 * MiBOf("self", line); }

// The spectrum's probabilities have errors of some 1e-8 of their own.
constexpr double kLawTolerance = 1e-7;

bool TakesSamples(v1::EnsembleSpec::Model model) {
  return model != v1::EnsembleSpec::CLOSED_FORM && model != v1::EnsembleSpec::SPECTRUM;
}

// In a gas of one column.
bool HasOneColumn(const std::string& cells) {
  return cells == "1" || absl::StartsWith(cells, "1x");
}

// Whether the estimate is exact although the model samples, or computes with an error.
bool IsExact(const v1::PointResult& result, const v1::Estimate& estimate) {
  if (estimate.has_exact() && estimate.value() == estimate.exact()) return true;
  const v1::PointParameters& point = result.parameters();
  // The piston is too slow to be overtaken.
  if (estimate.name() == "mean_sigma") return point.epsilon() >= 0.25;
  const bool is_of_the_limit =
      result.model() == v1::EnsembleSpec::MARKOV || result.model() == v1::EnsembleSpec::SPECTRUM;
  return is_of_the_limit && absl::StartsWith(estimate.name(), "conductivity") &&
         HasOneColumn(point.cells());
}

void CheckErrors(const v1::PointResult& result) {
  if (result.model() == v1::EnsembleSpec::CLOSED_FORM) return;
  for (const v1::Estimate& estimate : result.estimates()) {
    if (!estimate.has_standard_error() || IsExact(result, estimate)) continue;
    const double rounding =
        std::numeric_limits<double>::epsilon() / 2 * std::fabs(estimate.value());
    Require(estimate.standard_error() > 0 && estimate.standard_error() >= rounding, "false zero",
            estimate.name(), " is ", estimate.value(), " +- ", estimate.standard_error(), " from ",
            result.samples(), " samples by ", v1::EnsembleSpec::Model_Name(result.model()));
  }
}

void CheckMeasured(const v1::PointResult& result) {
  Require(!result.estimates().empty(), "measured", "no estimate");
  if (!TakesSamples(result.model()) || !result.remarks().empty()) return;
  Require(result.samples() >= 1, "measured", "0 samples, and no remark");
  const v1::Estimate& first = result.estimates(0);
  Require(result.samples() < kEnoughSamples || first.has_standard_error(), "measured", first.name(),
          " has from ", result.samples(), " samples no error, and no remark");
}

void CheckHealth(const v1::EnsembleSpec& spec, const v1::PointResult& result) {
  const double most = spec.precision() == v1::EnsembleSpec::SINGLE ? 1e-4 : 1e-9;
  Require(result.health().escapes() == 0 && result.health().max_energy_error() <= most, "health",
          result.health().ShortDebugString());
}

// The histograms of both signs of a velocity are one law.
void CheckLaws(const v1::PointResult& result) {
  std::map<std::string, double> sums;  // by law
  for (const v1::Histogram& histogram : result.histograms()) {
    const auto& expected = histogram.expected_probabilities();
    if (expected.empty()) continue;
    sums[histogram.sigma() == 0 ? absl::StrCat(histogram.name(), " at ", histogram.time())
                                : "both signs"] +=
        std::accumulate(expected.begin(), expected.end(), 0.0);
  }
  for (const auto& [law, sum] : sums) {
    Require(std::fabs(sum - 1) <= kLawTolerance, "law", "the probabilities of ", law,
            " sum to 1 + ", sum - 1);
  }
}

// ---- finite numbers ----

void Check(const std::string& name, std::initializer_list<std::optional<double>> values) {
  for (const std::optional<double>& value : values) {
    if (value) Require(std::isfinite(*value), "finite", "a number of ", name, " is ", *value);
  }
}

}  // namespace

void CheckAnswer(const v1::EnsembleSpec& spec, const v1::PointResult& result) {
  CheckFinite(result);
  CheckErrors(result);
  CheckMeasured(result);
  CheckHealth(spec, result);
  CheckLaws(result);
}

double CheckPlan(const v1::PointPlan& plan) {
  CheckFinite(plan);
  const v1::ModelPlan* chosen = nullptr;
  for (const v1::ModelPlan& model : plan.models()) {
    Require(model.samples() >= 0 && model.work() >= 0 && model.relative_statistical_error() >= 0 &&
                model.relative_model_error() >= 0,
            "plan", "a number is negative: ", model.ShortDebugString());
    if (model.model() == plan.model() && model.answers()) chosen = &model;
  }
  Require(chosen != nullptr, "plan", "no model answers");
  const bool has_samples = chosen->samples() >= 1 || !TakesSamples(chosen->model());
  Require(chosen->has_samples() && has_samples, "plan",
          "no samples are planned: ", chosen->ShortDebugString());
  Require(chosen->has_work() && chosen->work() <= kMostPlannedSeconds, "plan",
          "no machine can compute what is planned: ", chosen->ShortDebugString());
  return chosen->work();
}

PeakMemory::PeakMemory() : at_first_(BytesOf("VmRSS:")) {
  std::ofstream("/proc/self/clear_refs") << "5";  // forgets the largest value
}

double PeakMemory::Bytes() const { return BytesOf("VmHWM:") - at_first_; }

void CheckMemory(double planned, double measured) {
  Require(kIsSanitized || measured <= planned + kMemoryOfAnyAnswer, "memory", "planned ",
          1e-6 * planned, " MB, took ", 1e-6 * measured, " MB");
}

void CheckFinite(const google::protobuf::Message& message) {
  for (const absl::string_view line : absl::StrSplit(message.DebugString(), '\n')) {
    Require(!absl::EndsWith(line, " nan") && !absl::EndsWith(line, "inf"), "finite",
            absl::StripLeadingAsciiWhitespace(line));
  }
}

void CheckFinite(const PointSummary& summary) {
  // A small sample may contain nothing that determines a value.
  const bool is_small = !HasStatedError(static_cast<double>(summary.samples));
  for (const Estimate& estimate : summary.estimates) {
    if (is_small && std::isnan(estimate.value)) continue;
    Check(estimate.name, {estimate.value, estimate.standard_error, estimate.exact, estimate.limit,
                          estimate.noise_floor});
  }
  for (const Curve& curve : summary.curves) {
    for (const CurvePoint& point : curve.points) {
      Check(curve.name, {point.at, point.value, point.standard_error, point.limit});
    }
  }
  if (const auto& kl = summary.kl_divergence) {
    Check("relative entropy", {kl->value, kl->noise_floor, kl->noise_error, kl->standard_error});
  }
  for (const auto& [name, sigma, histogram, time] : summary.histograms) {
    Check(name, {histogram.lower, histogram.upper, time});
  }
  Check("health", {summary.health.max_energy_error});
}

}  // namespace ballpiston::questions
