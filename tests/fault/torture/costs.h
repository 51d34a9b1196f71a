// The processor time of a sample: of the server, and of the engine alone. Other load of the machine
// affects both, so their ratio does not depend on it if they are measured in turn.
#pragma once

#include "core/ensemble/point_fold.h"
#include "server/convert/spec.h"
#include "server/processor_time.h"
#include "tests/fault/torture/questions.h"

namespace ballpiston::torture {

// Seconds of the engine without the service, which answers the question in this thread.
inline double EngineCost(const v1::EnsembleSpec& question) {
  const auto experiment = PointExperiment::Create(server::CheckSpec(question).spec, 0);
  const double start = server::ThreadSeconds();
  const auto samples = static_cast<double>(FoldPoint(*experiment).samples);
  return (server::ThreadSeconds() - start) / samples;
}

// Seconds of all the server's threads, in the middle of a job that runs, for at least
// `least_samples`. A pause is between two requests for the job's progress, because without it they
// take a tenth of the processor time.
inline double ServerCost(const ServerProcess& server, const client::Client& client,
                         const std::string& job, double least_samples) {
  const auto samples = [&] {
    const v1::EnsembleJob now = OrThrow(client.Get(job));
    if (client::HasEnded(now.state())) throw std::runtime_error("the job is too short to measure");
    return now.progress().samples();
  };
  const double before = samples(), start = server.ProcessorSeconds();
  double more = 0;
  AwaitThat([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    more = samples() - before;
    return more >= least_samples;
  });
  return (server.ProcessorSeconds() - start) / more;
}

// The ratio of the first costs to the second. The pairs are added up in ten groups, because in the
// middle of a job only whole blocks are counted; the ratio is the groups' median, because something
// else may have disturbed some of them.
class PairedRatio {
 public:
  void Add(double first, double second) {
    first_.push_back(first);
    second_.push_back(second);
  }
  double ratio() const { return Median(Ratios()); }
  // From the groups' median deviation. The factors are those of a normal law: standard deviation /
  // median deviation, and standard error of the median / that of the mean.
  double StandardError() const {
    constexpr double kDeviations = 1.4826, kMedianError = 1.2533;
    std::vector<double> distances = Ratios();
    const double middle = Median(distances);
    for (double& distance : distances) distance = std::abs(distance - middle);
    const auto n = static_cast<double>(distances.size());
    return n < 2 ? INFINITY : kMedianError * kDeviations * Median(distances) / std::sqrt(n);
  }
  // (ratio - 1) in percent, with its error.
  std::string Text() const {
    return absl::StrFormat("%+.2f +- %.2f %%", 100 * (ratio() - 1), 100 * StandardError());
  }

 private:
  static double Median(std::vector<double> values) {
    if (values.empty()) return NAN;
    std::sort(values.begin(), values.end());
    const size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
  }
  std::vector<double> Ratios() const {
    const size_t groups = std::min<size_t>(10, first_.size());
    std::vector<double> ratios;
    for (size_t group = 0; group < groups; ++group) {
      double first = 0, second = 0;
      const size_t end = (group + 1) * first_.size() / groups;
      for (size_t i = group * first_.size() / groups; i < end; ++i) {
        first += first_[i];
        second += second_[i];
      }
      ratios.push_back(first / second);
    }
    return ratios;
  }

  std::vector<double> first_, second_;
};

}  // namespace ballpiston::torture
