#include "core/model_choice/sampling_cost.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/ensemble/experiment_kind.h"

namespace ballpiston {
namespace {

// In lanes only the ball's wall hits are events; the reference has one for each hit and collision.
double WallHits(Engine engine, const SampleWork& work) {
  const double of_the_ball = work.ball_wall + work.delays;
  if (engine != Engine::kReference) return of_the_ball;
  return of_the_ball + work.piston_wall + work.collisions + work.starts;
}

// The mean of the longest of n times from an exponential law, in units of their mean: 1 + 1/2 +
// ... + 1/n.
double LongestOfExponentials(double n) {
  return std::log(n) + std::numbers::egamma + (1 - std::numbers::egamma) / n;
}

// The same for flights of some parts each. Below one part, this share of the flights has an
// exponential law, and the others take no time.
double Longest(double n, double parts) {
  if (parts >= 1) return 1 + (LongestOfExponentials(n) - 1) / std::sqrt(parts);
  return n * parts < 1 ? n : LongestOfExponentials(n * parts) / parts;
}

// The first blocks of a point with long samples have two samples.
constexpr double kSamplesOfABlock = 2;

}  // namespace

double SamplingCost::ThreadsFor(double samples, int threads) const {
  return std::clamp(std::ceil(samples / (lanes * orbit)), 1.0, static_cast<double>(threads));
}

double SamplingCost::OfTheFirst(int threads) const {
  return std::max(first * threads, warm_up + stage * sample);
}

double SamplingCost::Of(double samples, int threads) const {
  const double used = ThreadsFor(samples, threads);
  const double at_the_end = std::min(samples / used, lanes * orbit);
  const double of_an_orbit = std::min(at_the_end, orbit);
  const double in_full_lanes = std::max(samples - used * lanes * orbit, 0.0);
  const double longest = of_an_orbit * Longest(at_the_end / of_an_orbit, parts * of_an_orbit);
  const double flights = in_full_lanes + used * lanes * longest;
  return warm_up + samples * (sample - flight) + flights * flight;
}

double SamplingCost::SamplesIn(double seconds, int threads) const {
  if (seconds < OfTheFirst(threads)) return 0;
  // The cost grows with the number of samples.
  double enough = 1, too_many = static_cast<double>(kMaxSamples);
  if (Of(too_many, threads) <= seconds) return too_many;
  while (too_many > enough * (1 + 1e-9) + 0.5) {
    const double middle = std::sqrt(enough * too_many);
    (Of(middle, threads) <= seconds ? enough : too_many) = middle;
  }
  const double whole = std::floor(enough);
  return Of(whole + 1, threads) <= seconds ? whole + 1 : whole;
}

SamplingCost CostOfSampling(const EnsembleSpec& spec, const PointParameters& point,
                            const MachineRates& rates) {
  const Forecast forecast = ForecastOf(spec, point);
  const SampleWork& work = forecast.work;
  const Engine engine = EngineFor(spec);
  const EngineRate& rate = rates.Of(engine);
  const double flight = WallHits(engine, work) * rate.wall_hit;
  SamplingCost cost = {.sample = flight + work.collisions * rate.collision +
                                 work.starts * rate.sample + work.jumps * rates.jump};
  if (const auto& trajectories = forecast.trajectories) {
    cost.stage = static_cast<double>(trajectories->count());
    cost.warm_up = cost.stage * static_cast<double>(trajectories->warm_up) * cost.sample;
  }
  if (work.together > 0) {
    cost.lanes = work.together;
    cost.first = work.together * cost.sample;
  } else if (spec.model == Model::kMarkov) {
    cost.first = kSamplesOfABlock * cost.sample;
  } else {
    cost.flight = flight;
    cost.lanes = rate.lanes;
    cost.orbit = static_cast<double>(spec.experiment->samples_together);
    cost.parts = work.parts;
    const double of_a_block = std::max(kSamplesOfABlock, cost.orbit);
    const double orbits = std::min(rate.lanes, of_a_block / cost.orbit);
    cost.first = cost.lanes * cost.orbit * flight * Longest(orbits, cost.parts * cost.orbit) +
                 of_a_block * (cost.sample - flight);
  }
  return cost;
}

}  // namespace ballpiston
