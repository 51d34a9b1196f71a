#include "tests/fault/torture/costs.h"

#include "client/library/job_watch.h"
#include "core/ensemble/point_fold.h"
#include "server/convert/spec.h"
#include "server/processor_time.h"
#include "tests/fault/torture/preamble.h"

namespace ballpiston::torture {
namespace {

// For a normal law: standard deviation / median deviation, and standard error of the median / that
// of the mean.
constexpr double kDeviations = 1.4826, kMedianError = 1.2533;

constexpr size_t kGroups = 10;

// Between two requests for the job's progress. Without a pause the requests take a tenth of the
// server's processor time.
constexpr std::chrono::milliseconds kPause(50);

double Sum(const std::vector<double>& values, size_t begin, size_t end) {
  const auto first = values.begin();
  return std::accumulate(first + static_cast<std::ptrdiff_t>(begin),
                         first + static_cast<std::ptrdiff_t>(end), 0.0);
}

double Median(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace

double EngineCost(const v1::EnsembleSpec& question) {
  const auto experiment = PointExperiment::Create(server::CheckSpec(question).spec, 0);
  const double start = server::ThreadSeconds();
  const auto samples = static_cast<double>(FoldPoint(*experiment)->samples);
  return (server::ThreadSeconds() - start) / samples;
}

double ServerCost(const ServerProcess& server, const client::Client& client,
                  const v1::EnsembleSpec& question) {
  const double start = server.ProcessorSeconds();
  const std::string name = OrThrow(client.Create(question, {.fresh = true})).name();
  const v1::EnsembleJob end =
      OrThrow(client.Watch(name, {}, {.give_up_after = absl::FromChrono(kPatience)}));
  return (server.ProcessorSeconds() - start) / end.progress().samples();
}

double ServerCost(const ServerProcess& server, const client::Client& client, const std::string& job,
                  double least_samples) {
  const auto samples = [&] {
    const v1::EnsembleJob now = OrThrow(client.Get(job));
    if (client::HasEnded(now.state())) throw std::runtime_error("the job is too short to measure");
    return now.progress().samples();
  };
  const double before = samples(), start = server.ProcessorSeconds();
  double more = 0;
  AwaitThat([&] {
    std::this_thread::sleep_for(kPause);
    more = samples() - before;
    return more >= least_samples;
  });
  return (server.ProcessorSeconds() - start) / more;
}

void PairedRatio::Add(double first, double second) {
  first_.push_back(first);
  second_.push_back(second);
}

double PairedRatio::ratio() const { return Median(Ratios()); }

double PairedRatio::StandardError() const {
  std::vector<double> distances = Ratios();
  const double middle = Median(distances);
  for (double& distance : distances) distance = std::abs(distance - middle);
  const auto n = static_cast<double>(distances.size());
  return n < 2 ? INFINITY : kMedianError * kDeviations * Median(distances) / std::sqrt(n);
}

std::vector<double> PairedRatio::Ratios() const {
  const size_t groups = std::min(kGroups, first_.size());
  std::vector<double> ratios;
  for (size_t i = 0; i < groups; ++i) {
    const size_t begin = i * first_.size() / groups, end = (i + 1) * first_.size() / groups;
    ratios.push_back(Sum(first_, begin, end) / Sum(second_, begin, end));
  }
  return ratios;
}

std::string PairedRatio::Text() const {
  return absl::StrFormat("%+.2f +- %.2f %%", 100 * (ratio() - 1), 100 * StandardError());
}

}  // namespace ballpiston::torture
