// The processor time of a sample: of the server, and of the engine alone. Other load of the machine
// affects both, so their ratio does not depend on it if they are measured in turn.
#pragma once

#include "client/library/client.h"
#include "tests/support/preamble.h"
#include "tests/support/server_process.h"

namespace ballpiston::torture {

// Seconds of the engine without the service, which answers the question in this thread.
double EngineCost(const v1::EnsembleSpec& question);

// Seconds of all the server's threads, from the creation of the job to its end.
double ServerCost(const ServerProcess& server, const client::Client& client,
                  const v1::EnsembleSpec& question);

// The same in the middle of a job that runs, for at least `least_samples`.
double ServerCost(const ServerProcess& server, const client::Client& client, const std::string& job,
                  double least_samples);

// The ratio of the first costs to the second. The pairs are added up in ten groups, because in the
// middle of a job only whole blocks are counted; the ratio is the groups' median, because something
// else may have disturbed some of them.
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
