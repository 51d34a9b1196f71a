// Readers that stall cost the server bounded memory, and the engine nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include "absl/strings/str_format.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/hung_readers.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/fault/torture/windows.h"

namespace ballpiston::torture {
namespace {

constexpr double kMostMiBEach = 8;
constexpr double kMostLoss = 0.01;
// Many points, so that what the readers do not read is much: 160 KB of specification, and every
// finished point.
constexpr int kPoints = 20'000;

class StalledReaders : public testing::Test {
 protected:
  StalledReaders() : server_({.workers = 2}) {
    server_.Start();
    client_.emplace(server_.Connect());
    const auto job = client_->Create(ManyPoints(kPoints, 20'000));
    if (!job.ok()) throw std::runtime_error(job.status().ToString());
    name_ = job->name();
    while (client_->Get(name_)->progress().points_done() < Size(20, 200)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  Window Look(std::chrono::milliseconds length) const {
    return ServerWindow(server_, *client_, name_, length);
  }

  // One window without readers, one with them when they have stalled.
  void Round(int readers, std::chrono::milliseconds length) {
    const double before = server_.ResidentMiB();
    const Window quiet = Look(length);
    const HungReaders hung(readers, server_.address(), name_);
    Look(length);  // the time to stall
    const Window stalled = Look(length);
    loss_.Add(stalled.ProcessorCost(), quiet.ProcessorCost());
    slower_.Add(stalled.Cost(), quiet.Cost());
    most_mib_ = std::max(most_mib_, (server_.ResidentMiB() - before) / readers);
  }

  Findings findings_{"stalled readers"};
  ServerProcess server_;
  std::optional<client::EnsembleClient> client_;
  std::string name_;
  PairedRatio loss_, slower_;
  double most_mib_ = 0;
};

TEST_F(StalledReaders, CostBoundedMemoryAndNoEngineTime) {
  const int readers = Size(10, 100);
  const int rounds = Size(3, 30);
  for (int i = 0; i < rounds; ++i) Round(readers, std::chrono::milliseconds(Size(300, 2000)));
  findings_.Count("stalled readers", readers);
  findings_.Count("pairs of windows", rounds);
  findings_.Note("most memory of one, MiB", absl::StrFormat("%.2f", most_mib_));
  findings_.Note("processor time a sample", loss_.Text());
  findings_.Note("time a sample", slower_.Text());
  EXPECT_LE(most_mib_, kMostMiBEach);
  if (HoldsToTimes()) {
    EXPECT_LT(loss_.ratio() - 1, kMostLoss + 3 * loss_.StandardError());
  }
}

}  // namespace
}  // namespace ballpiston::torture
