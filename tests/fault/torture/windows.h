// Compares two ways of running in short alternate windows, so that other load of the machine
// affects both equally.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "client/library/client.h"
#include "tests/support/server_process.h"

namespace ballpiston::torture {

struct Window {
  double samples = 0;
  double processor_seconds = 0;
  double seconds = 0;

  double ProcessorCost() const { return processor_seconds / samples; }
  double Cost() const { return seconds / samples; }

  Window& operator+=(const Window& other) {
    samples += other.samples;
    processor_seconds += other.processor_seconds;
    seconds += other.seconds;
    return *this;
  }
};

// Measures the processor time of all the server's threads, and the samples of a job in this time.
// The window has this length, but goes on until `least_samples` are done, because the machine may
// be busy.
Window ServerWindow(const ServerProcess& server, const client::Client& client,
                    const std::string& job, std::chrono::milliseconds length,
                    double least_samples = 1);

// The ratio of the first to the second. The pairs are added up in ten groups, because a window
// begins and ends within blocks that are only counted whole; the ratio is the groups' median,
// because something else may have disturbed some of them.
class PairedRatio {
 public:
  void Add(double first, double second);
  double ratio() const;
  double StandardError() const;  // from the groups' median deviation
  std::string Text() const;      // (ratio - 1) in percent, with its error

 private:
  std::vector<double> Ratios() const;

  std::vector<double> first_, second_;
};

}  // namespace ballpiston::torture
