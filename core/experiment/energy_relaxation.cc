#include "core/experiment/energy_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/predicted_hits.h"
#include "core/experiment/without_last_bits.h"
#include "core/markov/jump_process.h"
#include "core/sampling/invariant_measure.h"
#include "core/statistics/told_error.h"

namespace ballpiston {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();

// Time origins of the curve lie so many lags apart: half a mean free time, in which the energy
// forgets most, so that more of them would say little more.
constexpr size_t kLagsBetweenOrigins = 2;

// A walker that is slower than the others keeps all of a group walking.
constexpr uint64_t kWalkersInStep = 256;

// The error of a mean over orbits, if there are enough of them.
std::optional<double> ErrorOf(const Moments& moments) {
  return ToldError(static_cast<double>(moments.count), moments.StandardError());
}

// The integral, then the curve.
BlockResult NoOrbits() {
  BlockResult result;
  result.moments.resize(1 + kLags);
  return result;
}

// Measurements of a block's orbits, by orbit.
class OrbitMeasurements {
 public:
  OrbitMeasurements(const EnergyRelaxation& relaxation, uint64_t orbits)
      : relaxation_(relaxation), values_(orbits) {}

  void Set(uint64_t orbit, const StepFunction& energy) {
    values_[orbit] = relaxation_.Measure(energy);
  }

  // Those that were set.
  BlockResult Result() const {
    BlockResult result = NoOrbits();
    for (const std::vector<double>& values : values_) {
      if (values.empty()) continue;
      ++result.samples;
      for (size_t i = 0; i < values.size(); ++i) result.moments[i].Add(values[i]);
    }
    return result;
  }

 private:
  const EnergyRelaxation& relaxation_;
  std::vector<std::vector<double>> values_;
};

class RelaxingOrbits : public OrbitSource {
 public:
  RelaxingOrbits(const PairGeometry& geometry, const EnergyRelaxation& relaxation,
                 const RandomStream& random, uint64_t first, uint64_t orbits)
      : geometry_(geometry),
        relaxation_(relaxation),
        random_(random),
        first_(first),
        energies_(orbits),
        measurements_(relaxation, orbits) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random = random_.Sample(first_ + orbit);
    const PairState state = relaxation_.epsilon()
                                ? DrawFromFlowMeasureAt(geometry_, *relaxation_.epsilon(), random)
                                : DrawFromFlowMeasure(geometry_, random);
    energies_[orbit].emplace(state.piston_velocity * state.piston_velocity / 2);
    return state;
  }

  AfterContact Meet(uint64_t orbit, const Contact& contact) override {
    std::optional<StepFunction>& energy = energies_[orbit];
    if (contact.escaped) {
      ++health_.escapes;
      energy.reset();
      return AfterContact::kEnd;
    }
    if (!contact.expired) {
      // The piston leaves with what was the ball's normal component.
      const double v = contact.state.ball_speed * contact.state.direction.x();
      energy->Add(contact.time, v * v / 2);
      health_.max_energy_error = std::max(health_.max_energy_error, EnergyError(contact.state));
      if (energy->last_jump() < relaxation_.orbit_time()) return AfterContact::kGoOn;
    }
    measurements_.Set(orbit, *energy);
    energy.reset();
    return AfterContact::kEnd;
  }

  double TimeLimit() const override { return relaxation_.orbit_time(); }

  BlockResult Result() const {
    BlockResult result = measurements_.Result();
    result.health = health_;
    return result;
  }

 private:
  PairGeometry geometry_;
  const EnergyRelaxation& relaxation_;
  RandomStream random_;
  uint64_t first_;
  std::vector<std::optional<StepFunction>> energies_;  // of the orbits that run
  OrbitMeasurements measurements_;
  Health health_;
};

std::vector<double> StartsOfWalkers(const std::optional<double>& epsilon,
                                    const RandomStream& random, uint64_t first, uint64_t count) {
  std::vector<double> u(count);
  for (uint64_t i = 0; i < count; ++i) {
    u[i] = epsilon ? std::sqrt(2 * *epsilon) : random.Sample(first + i).Uniform();
  }
  return u;
}

// Energies of `count` walkers up to orbit_time, in units of the geometry.
std::vector<StepFunction> WalkTogether(const EnergyRelaxation& relaxation,
                                       const RandomStream& random, uint64_t first, uint64_t count) {
  const std::vector<double> starts = StartsOfWalkers(relaxation.epsilon(), random, first, count);
  JumpWalkers walkers(random.seed, random.stream, first, starts);
  std::vector<StepFunction> energies;
  for (const double u : starts) energies.emplace_back(u * u / 2);
  for (bool walking = true; walking;) {
    walkers.Jump();
    walking = false;
    for (uint64_t i = 0; i < count; ++i) {
      if (energies[i].last_jump() >= relaxation.orbit_time()) continue;
      const double u = walkers.u()[i];
      energies[i].Add(relaxation.unit() * walkers.waiting_times()[i], u * u / 2);
      walking = true;
    }
  }
  return energies;
}

}  // namespace

bool HasRelaxationTime(const std::optional<double>& epsilon) {
  return !epsilon || *epsilon <= kNoDecayFrom || *epsilon >= kNoDecayTo;
}

double CollisionsPerOrbit(const PointParameters& point) {
  return point.epsilon ? kWindowTimes : kOriginTimes + kWindowTimes;
}

// ---- scales and estimates ----

EnergyRelaxation::EnergyRelaxation(const PairGeometry& geometry, const PointParameters& point)
    : epsilon_(point.epsilon),
      unit_of_limit_(MeanFreeTimesOf(geometry).ball_piston / 4),
      unit_(WithoutLastBits(unit_of_limit_)),
      mean_free_time_(4 * unit_) {}

double EnergyRelaxation::orbit_time() const {
  return epsilon_ ? window() : kOriginTimes * mean_free_time_ + window();
}

std::vector<double> EnergyRelaxation::Measure(const StepFunction& energy) const {
  if (epsilon_) {
    std::vector<double> values = energy.Samples(Lag(1), kLags);
    values.insert(values.begin(), energy.Integral(kMeanPistonEnergy, window()));
    return values;
  }
  std::vector<double> values(1 + kLags);
  values[0] =
      energy.CorrelationIntegral(kMeanPistonEnergy, kOriginTimes * mean_free_time_, window()) /
      kVarianceOfPistonEnergy;
  const auto steps = static_cast<size_t>((kLags - 1) * kOriginTimes / kWindowTimes);
  std::vector<double> samples = energy.Samples(Lag(1), steps + kLags - 1);
  for (double& sample : samples) sample -= kMeanPistonEnergy;
  for (size_t origin = 0; origin < steps; origin += kLagsBetweenOrigins) {
    for (size_t lag = 0; lag < kLags; ++lag) {
      values[1 + lag] += samples[origin] * samples[origin + lag];
    }
  }
  const double origins = static_cast<double>(steps / kLagsBetweenOrigins);
  for (size_t lag = 0; lag < kLags; ++lag) {
    values[1 + lag] /= origins * kVarianceOfPistonEnergy;
  }
  return values;
}

SpectralValue EnergyRelaxation::IntegralOfLimit(double window) const {
  const RelaxationSpectrum& spectrum = RelaxationSpectrum::Get();
  const double end = window / unit_of_limit_;
  const SpectralValue integral =
      epsilon_ ? spectrum.DecayIntegral(*epsilon_, end) : spectrum.CorrelationTime(end);
  return {unit_of_limit_ * integral.value, unit_of_limit_ * integral.error};
}

std::vector<Estimate> EnergyRelaxation::Named(const Estimate& integral) const {
  if (!HasRelaxationTime(epsilon_)) return {integral};
  Estimate time = integral;
  time.name = "relaxation_time";
  if (!epsilon_) return {time};
  const double scale = 1 / (*epsilon_ - kMeanPistonEnergy);
  time.value *= scale;
  if (time.standard_error) *time.standard_error *= std::fabs(scale);
  *time.limit *= scale;
  return {time, integral};
}

std::vector<Estimate> EnergyRelaxation::Estimates(const BlockResult& merged) const {
  const double limit = IntegralOfLimit(kForEver).value;
  const double remainder = WithoutLastBits(limit - IntegralOfLimit(window()).value);
  return Named({.name = "decay_integral",
                .value = merged.moments[0].mean + remainder,
                .standard_error = ErrorOf(merged.moments[0]),
                .limit = limit});
}

std::vector<Estimate> EnergyRelaxation::EstimatesOfLimit() const {
  const SpectralValue integral = IntegralOfLimit(kForEver);
  return Named({.name = "decay_integral",
                .value = integral.value,
                .standard_error = integral.error,
                .limit = integral.value});
}

std::string EnergyRelaxation::CurveName() const {
  return epsilon_ ? "mean_energy" : "energy_autocorrelation";
}

SpectralValue EnergyRelaxation::CurveOfLimitAt(double time) const {
  const RelaxationSpectrum& spectrum = RelaxationSpectrum::Get();
  return epsilon_ ? spectrum.MeanEnergy(*epsilon_, time / unit_of_limit_)
                  : spectrum.Autocorrelation(time / unit_of_limit_);
}

Curve EnergyRelaxation::MeasuredCurve(const BlockResult& merged) const {
  Curve curve = {.name = CurveName()};
  for (size_t i = 0; i < kLags; ++i) {
    const Moments& measured = merged.moments[1 + i];
    curve.points.push_back({.time = Lag(i),
                            .value = measured.mean,
                            .standard_error = ErrorOf(measured),
                            .limit = CurveOfLimitAt(Lag(i)).value});
  }
  return curve;
}

Curve EnergyRelaxation::CurveOfLimit() const {
  Curve curve = {.name = CurveName()};
  for (size_t i = 0; i < kLags; ++i) {
    const SpectralValue limit = CurveOfLimitAt(Lag(i));
    curve.points.push_back({.time = Lag(i),
                            .value = limit.value,
                            .standard_error = limit.error,
                            .limit = limit.value});
  }
  return curve;
}

// ---- experiments ----

EnergyRelaxationExperiment::EnergyRelaxationExperiment(const EnsembleSpec& spec,
                                                       const PointParameters& point,
                                                       const PairGeometry& geometry)
    : PointExperiment(
          spec, point,
          PlanBlocks(spec, CollisionsPerOrbit(point) * EventsPerCollision(spec.model, geometry),
                     CollisionsPerOrbit(point))),
      geometry_(geometry),
      relaxation_(geometry, point) {}

std::optional<BlockResult> EnergyRelaxationExperiment::RunBlock(uint64_t block,
                                                                std::stop_token stop) const {
  return answer().model == Model::kMarkov ? RunJumpProcess(block, stop) : RunBilliard(block, stop);
}

std::optional<BlockResult> EnergyRelaxationExperiment::RunBilliard(
    uint64_t block, const std::stop_token& stop) const {
  const uint64_t count = plan().SamplesIn(block);
  RelaxingOrbits orbits(geometry_, relaxation_, random(), plan().FirstSample(block), count);
  if (!RunOrbits(engine(), geometry_, count, orbits, stop)) return std::nullopt;
  return orbits.Result();
}

std::optional<BlockResult> EnergyRelaxationExperiment::RunJumpProcess(
    uint64_t block, const std::stop_token& stop) const {
  const uint64_t first = plan().FirstSample(block), count = plan().SamplesIn(block);
  OrbitMeasurements measurements(relaxation_, count);
  for (uint64_t done = 0; done < count; done += kWalkersInStep) {
    if (stop.stop_requested()) return std::nullopt;
    const uint64_t together = std::min(kWalkersInStep, count - done);
    const auto energies = WalkTogether(relaxation_, random(), first + done, together);
    for (uint64_t i = 0; i < together; ++i) measurements.Set(done + i, energies[i]);
  }
  return measurements.Result();
}

BlockResult EnergyRelaxationExperiment::EmptyResult() const { return NoOrbits(); }

std::vector<Estimate> EnergyRelaxationExperiment::Estimates(const BlockResult& merged) const {
  std::vector<Estimate> estimates = relaxation_.Estimates(merged);
  if (answer().model != Model::kMarkov) return estimates;
  // The jump process is the limit.
  for (Estimate& estimate : estimates) estimate.exact = estimate.limit;
  return estimates;
}

Estimate EnergyRelaxationExperiment::FirstEstimate(const BlockResult& merged) const {
  return Estimates(merged).front();
}

namespace {

Estimate SpectralGap() {
  const SpectralValue gap = RelaxationSpectrum::Get().Gap();
  return {.name = "spectral_gap", .value = gap.value, .standard_error = gap.error};
}

}  // namespace

PointSummary EnergyRelaxationExperiment::Summarize(const BlockResult& merged) const {
  PointSummary summary = {.samples = merged.samples, .health = merged.health};
  summary.estimates = Estimates(merged);
  if (answer().model == Model::kMarkov) summary.estimates.push_back(SpectralGap());
  summary.curves.push_back(relaxation_.MeasuredCurve(merged));
  return summary;
}

namespace {

// The isolated rates after the gap.
void AddFurtherRates(std::vector<Estimate>& estimates) {
  const std::vector<SpectralValue> rates = RelaxationSpectrum::Get().IsolatedRates();
  for (size_t i = 1; i < rates.size(); ++i) {
    estimates.push_back({.name = absl::StrCat("isolated_rate_", i + 1),
                         .value = rates[i].value,
                         .standard_error = rates[i].error});
  }
}

}  // namespace

PointSummary EnergyRelaxationBySpectrum(const PairGeometry& geometry,
                                        const PointParameters& point) {
  const EnergyRelaxation relaxation(geometry, point);
  PointSummary summary;
  summary.estimates = relaxation.EstimatesOfLimit();
  summary.estimates.push_back(SpectralGap());
  AddFurtherRates(summary.estimates);
  summary.curves = {relaxation.CurveOfLimit()};
  return summary;
}

}  // namespace ballpiston
