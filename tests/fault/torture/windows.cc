#include "tests/fault/torture/windows.h"

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "absl/strings/str_format.h"

namespace ballpiston::torture {
namespace {

using Clock = std::chrono::steady_clock;

struct Reading {
  double samples = 0;
  double processor_seconds = 0;
  Clock::time_point at;
};

Reading Read(const ServerProcess& server, const client::EnsembleClient& client,
             const std::string& job) {
  const auto now = client.Get(job);
  if (!now.ok()) throw std::runtime_error(now.status().ToString());
  return {now->progress().samples(), server.ProcessorSeconds(), Clock::now()};
}

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

Window ServerWindow(const ServerProcess& server, const client::EnsembleClient& client,
                    const std::string& job, std::chrono::milliseconds length) {
  const Reading start = Read(server, client, job);
  std::this_thread::sleep_for(length);
  const Reading end = Read(server, client, job);
  return {end.samples - start.samples, end.processor_seconds - start.processor_seconds,
          std::chrono::duration<double>(end.at - start.at).count()};
}

void PairedRatio::Add(double first, double second) {
  first_.push_back(first);
  second_.push_back(second);
}

double PairedRatio::ratio() const { return Sum(first_) / Sum(second_); }

double PairedRatio::StandardError() const {
  const auto n = static_cast<double>(first_.size());
  double squares = 0;
  for (size_t i = 0; i < first_.size(); ++i) {
    const double residual = first_[i] - ratio() * second_[i];
    squares += residual * residual;
  }
  return n < 2 ? INFINITY : std::sqrt(n / (n - 1) * squares) / Sum(second_);
}

std::string PairedRatio::Text() const {
  return absl::StrFormat("%+.2f +- %.2f %%", 100 * (ratio() - 1), 100 * StandardError());
}

}  // namespace ballpiston::torture
