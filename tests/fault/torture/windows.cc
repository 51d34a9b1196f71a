#include "tests/fault/torture/windows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "absl/strings/str_format.h"
#include "client/library/job_watch.h"
#include "tests/fault/torture/questions.h"
#include "tests/support/await.h"

namespace ballpiston::torture {
namespace {

using Clock = std::chrono::steady_clock;

struct Reading {
  double samples = 0;
  double processor_seconds = 0;
  Clock::time_point at;
};

Reading Read(const ServerProcess& server, const client::Client& client, const std::string& job) {
  const v1::EnsembleJob now = OrThrow(client.Get(job));
  if (client::HasEnded(now.state())) throw std::runtime_error("the job is too short to measure");
  return {now.progress().samples(), server.ProcessorSeconds(), Clock::now()};
}

// For a normal law: standard deviation / median deviation, and standard error of the median / that
// of the mean.
constexpr double kDeviations = 1.4826, kMedianError = 1.2533;

constexpr size_t kGroups = 10;

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

Window ServerWindow(const ServerProcess& server, const client::Client& client,
                    const std::string& job, std::chrono::milliseconds length,
                    double least_samples) {
  const Reading start = Read(server, client, job);
  Reading end;
  AwaitThat([&] {
    std::this_thread::sleep_for(length);
    end = Read(server, client, job);
    return end.samples - start.samples >= least_samples;
  });
  return {end.samples - start.samples, end.processor_seconds - start.processor_seconds,
          std::chrono::duration<double>(end.at - start.at).count()};
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
