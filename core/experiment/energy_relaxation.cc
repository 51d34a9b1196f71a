#include "core/experiment/energy_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/arithmetic/elementary_functions.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/expected_returns.h"
#include "core/markov/energy_law.h"

namespace ballpiston {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();

// The distance of the curve's time origins, in lags: half a mean free time. In this time the energy
// loses most of its correlation, so more origins would add little information.
constexpr size_t kLagsBetweenOrigins = 2;

// In equilibrium one orbit in eight counts as an event: the few with a slow piston, whose energy is
// constant for long, skew the law of the integral. Intervals of 95 % from 64 and 256 orbits covered
// in 91.6 and 93.6 %.
constexpr double kEventsOfACorrelation = 0.125;

}  // namespace

bool HasRelaxationTime(const std::optional<double>& epsilon) {
  return !epsilon || *epsilon <= kNoDecayFrom || *epsilon >= kNoDecayTo;
}

std::vector<std::string> RemarksOnDecay(const std::optional<double>& epsilon) {
  if (HasRelaxationTime(epsilon)) return {};
  return {absl::StrCat(
      "there is no relaxation_time for epsilon between ", kNoDecayFrom, " and ", kNoDecayTo,
      ": the start is close to 1/6, and the mean energy first moves away from 1/6")};
}

double CollisionsPerOrbit(const PointParameters& point) {
  return point.Find(kEpsilon) ? kWindowTimes : kOriginTimes + kWindowTimes;
}

EnergyRelaxation::EnergyRelaxation(const PairGeometry& geometry, const PointParameters& point,
                                   Model model)
    : model_(model),
      epsilon_(point.Find(kEpsilon)),
      unit_of_limit_(MeanFreeTimesOf(geometry).ball_piston / 4),
      unit_(WithoutLastBits(unit_of_limit_)),
      mean_free_time_(4 * unit_),
      events_per_orbit_(model == Model::kMarkov ? 1
                        : epsilon_              ? ShareThatMeets(geometry, *epsilon_, window())
                                                : kEventsOfACorrelation),
      return_time_(epsilon_ ? ConditionalMeanFreeTime(geometry, *epsilon_) : 0) {}

double EnergyRelaxation::orbit_time() const {
  return epsilon_ ? window() : kOriginTimes * mean_free_time_ + window();
}

BlockResult EnergyRelaxation::Empty() const {
  BlockResult result;
  result.moments.resize(1 + kLags);
  if (epsilon_) result.histograms.assign(kLawLags.size(), Histogram::OfBins(0, 0.5, kEnergyBins));
  return result;
}

void EnergyRelaxation::Record(const std::vector<double>& values, BlockResult& result) const {
  ++result.samples;
  for (size_t i = 0; i < values.size(); ++i) result.moments[i].Add(values[i]);
  for (size_t i = 0; i < result.histograms.size(); ++i) {
    result.histograms[i].Add(values[1 + kLawLags[i]]);
  }
}

std::vector<double> EnergyRelaxation::Measure(const StepFunction& energy) const {
  std::vector<double> values(1 + kLags);
  if (epsilon_) {
    values[0] = energy.Integral(kMeanPistonEnergy, window());
    std::ranges::copy(energy.Samples(Lag(1), kLags), values.begin() + 1);
    return values;
  }
  values[0] =
      energy.CorrelationIntegral(kMeanPistonEnergy, kOriginTimes * mean_free_time_, window()) /
      kVarianceOfPistonEnergy;
  const ByLag curve = Autocorrelation(energy) / kVarianceOfPistonEnergy;
  std::copy(curve.begin(), curve.end(), values.begin() + 1);
  return values;
}

// Mean over the time origins. The array has a fixed size, so that the compiler can vectorise it:
// these products are most of the cost of a sample of the jump process.
EnergyRelaxation::ByLag EnergyRelaxation::Autocorrelation(const StepFunction& energy) const {
  constexpr size_t kSteps = static_cast<size_t>((kLags - 1) * kOriginTimes / kWindowTimes);
  std::vector<double> samples = energy.Samples(Lag(1), kSteps + kLags - 1);
  for (double& sample : samples) sample -= kMeanPistonEnergy;
  ByLag sum = ByLag::Zero();
  for (size_t origin = 0; origin < kSteps; origin += kLagsBetweenOrigins) {
    sum += samples[origin] * ByLag::Map(&samples[origin]);
  }
  return sum / (kSteps / kLagsBetweenOrigins);
}

BoundedValue EnergyRelaxation::IntegralOfLimit(double window) const {
  const RelaxationSpectrum& spectrum = RelaxationSpectrum::Get();
  const double end = window / unit_of_limit_;
  const BoundedValue integral =
      epsilon_ ? spectrum.DecayIntegral(*epsilon_, end) : spectrum.CorrelationTime(end);
  return {unit_of_limit_ * integral.value, unit_of_limit_ * integral.error};
}

BoundedValue EnergyRelaxation::IntegralOfLimit() const { return IntegralOfLimit(kForEver); }

std::optional<Estimate> EnergyRelaxation::MeasuredIntegral(const BlockResult& merged) const {
  std::optional<Estimate> integral = MeanAt(0, events_per_orbit_)(merged);
  const double limit = IntegralOfLimit().value;
  integral->value += WithoutLastBits(limit - IntegralOfLimit(window()).value);
  integral->limit = limit;
  if (model_ == Model::kMarkov) integral->exact = limit;
  return integral;
}

std::vector<Measurement> EnergyRelaxation::Table() const {
  const auto reading = [this](const BlockResult& merged) { return MeasuredIntegral(merged); };
  const double in_time = epsilon_ ? 1 / (*epsilon_ - kMeanPistonEnergy) : 1;
  std::vector<Measurement> table;
  if (HasRelaxationTime(epsilon_)) table.push_back({"relaxation_time", reading, in_time});
  if (epsilon_) table.push_back({"decay_integral", reading});
  if (model_ != Model::kSpectrum) return table;
  const BoundedValue limit = IntegralOfLimit();
  for (Measurement& row : table) {
    row.known = {row.scale * limit.value, std::fabs(row.scale) * limit.error};
    row.limit = row.known->value;
  }
  return table;
}

Curve EnergyRelaxation::MeasuredCurve(const BlockResult& merged) const {
  Curve curve = CurveOfLimit();
  if (merged.samples == 0) curve.points.clear();
  // One orbit more that has relaxed: if a second collision at once undoes the first one, few of the
  // orbits that meet have another energy, and a small sample may contain none of them.
  const double from_mean = epsilon_.value_or(0) - kMeanPistonEnergy;
  const double one_more = std::hypot(from_mean, std::sqrt(kVarianceOfPistonEnergy)) /
                          static_cast<double>(merged.samples);
  for (size_t i = 0; i < curve.points.size(); ++i) {
    const bool is_later = epsilon_ && i > 0;
    const double events =
        is_later ? std::min(events_per_orbit_, Lag(i) / return_time_) : events_per_orbit_;
    Estimate there = *MeanAt(1 + i, events)(merged);
    there.limit = curve.points[i].limit;
    if (is_later && there.standard_error) {
      there.standard_error = std::hypot(*there.standard_error, one_more);
    }
    curve.points[i] = CurvePointOf(Lag(i), there);
  }
  return curve;
}

std::vector<NamedHistogram> EnergyRelaxation::MeasuredLaws(const BlockResult& merged) const {
  std::vector<NamedHistogram> laws;
  for (const Histogram& histogram : merged.histograms) {
    const double time = Lag(kLawLags[laws.size()]);
    laws.push_back({.name = "piston_energy", .histogram = histogram, .time = time});
  }
  return laws;
}

std::vector<NamedHistogram> EnergyRelaxation::LawsOfLimit() const {
  std::vector<NamedHistogram> laws = MeasuredLaws(Empty());
  for (NamedHistogram& law : laws) law.histogram.counts.clear();
  return laws;
}

std::vector<std::vector<double>> EnergyRelaxation::ProbabilitiesOfLimit() const {
  static const auto* const law =
      new EnergyLaw(kEnergyLawDiscretisation, static_cast<int>(kEnergyBins));
  std::vector<std::vector<double>> probabilities;
  if (!epsilon_) return probabilities;
  const EnergyLaw::Start start = law->From(*epsilon_);
  for (const size_t lag : kLawLags) {
    probabilities.push_back(law->Probabilities(start, Lag(lag) / unit_of_limit_));
  }
  return probabilities;
}

// The first point of a mean energy is the energy that was asked for, without the spectrum's
// rounding.
Curve EnergyRelaxation::CurveOfLimit() const {
  const RelaxationSpectrum& spectrum = RelaxationSpectrum::Get();
  Curve curve = {.name = epsilon_ ? "mean_energy" : "energy_autocorrelation"};
  for (size_t i = 0; i < kLags; ++i) {
    const double time = Lag(i) / unit_of_limit_;
    const auto [limit, error] = !epsilon_ ? spectrum.Autocorrelation(time)
                                : i == 0  ? BoundedValue{*epsilon_, 0}
                                          : spectrum.MeanEnergy(*epsilon_, time);
    curve.points.push_back({.at = Lag(i), .value = limit, .standard_error = error, .limit = limit});
  }
  return curve;
}

}  // namespace ballpiston
