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

void CheckErrors(const v1::PointResult& result, Findings& findings) {
  if (result.model() == v1::EnsembleSpec::CLOSED_FORM) return;
  for (const v1::Estimate& estimate : result.estimates()) {
    if (!estimate.has_standard_error() || IsExact(result, estimate)) continue;
    const double rounding =
        std::numeric_limits<double>::epsilon() / 2 * std::fabs(estimate.value());
    if (estimate.standard_error() <= 0 || estimate.standard_error() < rounding) {
      findings.push_back(
          {"false zero",
           absl::StrCat(estimate.name(), " is ", estimate.value(), " +- ",
                        estimate.standard_error(), " from ", result.samples(), " samples by ",
                        v1::EnsembleSpec::Model_Name(result.model()))});
    }
  }
}

void CheckMeasured(const v1::PointResult& result, Findings& findings) {
  if (result.estimates().empty()) {
    findings.push_back({"measured", "no estimate"});
    return;
  }
  if (!TakesSamples(result.model()) || !result.remarks().empty()) return;
  if (result.samples() < 1) {
    findings.push_back({"measured", "0 samples, and no remark"});
  } else if (result.samples() >= kEnoughSamples && !result.estimates(0).has_standard_error()) {
    findings.push_back(
        {"measured", absl::StrCat(result.estimates(0).name(), " has from ", result.samples(),
                                  " samples no error, and no remark")});
  }
}

void CheckHealth(const v1::EnsembleSpec& spec, const v1::PointResult& result, Findings& findings) {
  const double most = spec.precision() == v1::EnsembleSpec::SINGLE ? 1e-4 : 1e-9;
  if (result.health().escapes() == 0 && result.health().max_energy_error() <= most) return;
  findings.push_back({"health", result.health().ShortDebugString()});
}

void CheckLaws(const v1::PointResult& result, Findings& findings) {
  double both_signs = 0;
  for (const v1::Histogram& histogram : result.histograms()) {
    if (histogram.expected_probabilities().empty()) continue;
    double sum = std::accumulate(histogram.expected_probabilities().begin(),
                                 histogram.expected_probabilities().end(), 0.0);
    if (histogram.sigma() != 0) {
      both_signs += sum;
      continue;
    }
    if (!(std::fabs(sum - 1) <= kLawTolerance)) {
      findings.push_back({"law", absl::StrCat("the probabilities of ", histogram.name(),
                                              " sum to 1 + ", sum - 1)});
    }
  }
  if (both_signs != 0 && !(std::fabs(both_signs - 1) <= kLawTolerance)) {
    findings.push_back(
        {"law", absl::StrCat("the probabilities of alpha sum to 1 + ", both_signs - 1)});
  }
}

// ---- finite numbers ----

void Check(const std::string& name, std::initializer_list<std::optional<double>> values,
           Findings& findings) {
  for (const std::optional<double>& value : values) {
    if (value && !std::isfinite(*value)) {
      findings.push_back({"finite", absl::StrCat("a number of ", name, " is ", *value)});
    }
  }
}

}  // namespace

Findings CheckAnswer(const v1::EnsembleSpec& spec, const v1::PointResult& result) {
  Findings findings = CheckFinite(result);
  CheckErrors(result, findings);
  CheckMeasured(result, findings);
  CheckHealth(spec, result, findings);
  CheckLaws(result, findings);
  return findings;
}

const v1::ModelPlan* Chosen(const v1::PointPlan& plan) {
  for (const v1::ModelPlan& model : plan.models()) {
    if (model.model() == plan.model() && model.answers()) return &model;
  }
  return nullptr;
}

Findings CheckPlan(const v1::PointPlan& plan) {
  Findings findings = CheckFinite(plan);
  const auto add = [&](const auto&... what) {
    findings.push_back({"plan", absl::StrCat(what...)});
  };
  for (const v1::ModelPlan& model : plan.models()) {
    if (model.samples() < 0 || model.work() < 0 || model.relative_statistical_error() < 0 ||
        model.relative_model_error() < 0) {
      add("a number is negative: ", model.ShortDebugString());
    }
  }
  const v1::ModelPlan* const chosen = Chosen(plan);
  if (chosen == nullptr) {
    add("no model answers");
    return findings;
  }
  if (!chosen->has_samples() || (TakesSamples(chosen->model()) && chosen->samples() < 1)) {
    add("no samples are planned: ", chosen->ShortDebugString());
  }
  if (!chosen->has_work() || chosen->work() > kMostPlannedSeconds) {
    add("no machine can compute what is planned: ", chosen->ShortDebugString());
  }
  return findings;
}

PeakMemory::PeakMemory() : at_first_(BytesOf("VmRSS:")) {
  std::ofstream("/proc/self/clear_refs") << "5";  // forgets the largest value
}

double PeakMemory::Bytes() const { return BytesOf("VmHWM:") - at_first_; }

Findings CheckMemory(double planned, double measured) {
  if (kIsSanitized || measured <= planned + kMemoryOfAnyAnswer) return {};
  return {{"memory",
           absl::StrFormat("planned %.0f MB, took %.0f MB", 1e-6 * planned, 1e-6 * measured)}};
}

Findings CheckFinite(const google::protobuf::Message& message) {
  Findings findings;
  for (const absl::string_view line : absl::StrSplit(message.DebugString(), '\n')) {
    if (absl::EndsWith(line, " nan") || absl::EndsWith(line, "inf")) {
      findings.push_back({"finite", std::string(absl::StripLeadingAsciiWhitespace(line))});
    }
  }
  return findings;
}

Findings CheckFinite(const PointSummary& summary) {
  Findings findings;
  // A small sample may contain nothing that determines a value.
  const bool is_small = !HasStatedError(static_cast<double>(summary.samples));
  for (const Estimate& estimate : summary.estimates) {
    if (is_small && std::isnan(estimate.value)) continue;
    Check(estimate.name,
          {estimate.value, estimate.standard_error, estimate.exact, estimate.limit,
           estimate.noise_floor},
          findings);
  }
  for (const Curve& curve : summary.curves) {
    for (const CurvePoint& point : curve.points) {
      Check(curve.name, {point.at, point.value, point.standard_error, point.limit}, findings);
    }
  }
  if (const auto& kl = summary.kl_divergence) {
    Check("relative entropy", {kl->value, kl->noise_floor, kl->noise_error, kl->standard_error},
          findings);
  }
  for (const auto& [name, sigma, histogram, time] : summary.histograms) {
    Check(name, {histogram.lower, histogram.upper, time}, findings);
  }
  Check("health", {summary.health.max_energy_error}, findings);
  return findings;
}

}  // namespace ballpiston::questions
