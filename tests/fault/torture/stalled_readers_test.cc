// Stalled readers use bounded memory in the server, and no time of the engine.
#include "tests/fault/torture/costs.h"
#include "tests/fault/torture/stalled_watches.h"

namespace ballpiston::torture {
namespace {

constexpr double kMostMiB = 64;  // of all readers
constexpr double kMostLoss = 0.01;
constexpr int kPoints = 40'000;  // many, so that the unread data is large
constexpr int kFinishedBefore = 600;
constexpr int kFinishedMeanwhile = 10;
constexpr int kWorkers = 2;
constexpr int kSlices = 12;  // of a measurement
// Readers that get messages for so long have not stalled.
constexpr std::chrono::milliseconds kLongestToStall = kPatience;

class StalledReaders : public testing::Test {
 protected:
  StalledReaders() : server_({.workers = kWorkers}) {
    server_.Start();
    client_.emplace(server_.NewClient());
    name_ = OrThrow(client_->Create(ManyPoints(kPoints, Size(3'000, 60'000)))).name();
    AwaitFinished(kFinishedBefore);
  }

  int Finished() const { return client_->Get(name_)->progress().points_done(); }

  void AwaitFinished(int points) const {
    AwaitThat([&] { return Finished() >= std::min(points, kPoints); });
  }

  // The processor time of a sample, relative to that of the engine alone, because the machine's
  // speed changes: by some 10 % within a second, so both are measured in turn in short slices.
  double Cost() {
    double cost = 0;
    for (int slice = 0; slice < kSlices; ++slice) {
      const double with_service = ServerCost(server_, *client_, name_, least_samples_);
      server_.Signal(SIGSTOP);
      cost += with_service / EngineCost(reference_) / kSlices;
      server_.Signal(SIGCONT);
    }
    return cost;
  }

  struct Stalled {
    double cost = 0;
    int silent = 0;    // readers that got no message meanwhile
    int finished = 0;  // points, meanwhile
  };
  Stalled LookWithReaders() {
    StalledWatches stalled(readers_, server_.address(), name_);
    std::this_thread::sleep_for(to_stall_);
    const int first = Finished();
    const double cost = Cost();
    most_mib_ = std::max(most_mib_, server_.ResidentMiB() - mib_without_);
    AwaitFinished(first + kFinishedMeanwhile);  // otherwise silence would prove nothing
    const int last = Finished();
    // A message made at either of the two moments may have either number.
    return {cost, stalled.CountSilent(first, last), last - first};
  }

  // Measures with stalled readers, and checks that they have stalled. If the server was too busy to
  // send them enough in time, new readers get more time.
  double CostWithStalled() {
    Stalled stalled = LookWithReaders();
    while (stalled.silent < readers_ && to_stall_ < kLongestToStall) {
      to_stall_ *= 2;
      stalled = LookWithReaders();
    }
    findings_.Count("readers stalled", readers_);
    findings_.Count("of which were told nothing meanwhile", stalled.silent);
    findings_.Count("points that finished meanwhile", stalled.finished);
    return stalled.cost;
  }

  // The order alternates, because the cost of the question grows with time.
  void Round(bool stalled_first) {
    double stalled = 0;
    if (stalled_first) stalled = CostWithStalled();
    std::this_thread::sleep_for(pause_);  // the time to recover
    const double quiet = Cost();
    if (!stalled_first) stalled = CostWithStalled();
    processor_.Add(stalled, quiet);
  }

  const int readers_ = Size(10, 250);
  const double least_samples_ = Size(3'000, 800'000);  // of a slice
  const v1::EnsembleSpec reference_ = ManyPoints(1, Size(10'000, 400'000));
  const std::chrono::milliseconds pause_{Size(150, 2000)};
  std::chrono::milliseconds to_stall_ = pause_;
  Findings findings_{"stalled readers"};
  ConnectedServer server_;
  std::optional<client::Client> client_;
  std::string name_;
  double mib_without_ = 0;
  PairedRatio processor_;
  double most_mib_ = 0;
};

TEST_F(StalledReaders, UseBoundedMemoryAndNoEngineTime) {
  mib_without_ = server_.ResidentMiB();
  const int rounds = Size(2, 20);
  for (int i = 0; i < rounds; ++i) Round(i % 2 == 1);
  findings_.Count("readers at once", readers_);
  findings_.Note("most memory of all, MiB", absl::StrFormat("%.1f", most_mib_));
  findings_.Note("processor time a sample, with over without", processor_.Text());
  EXPECT_EQ(findings_.count("of which were told nothing meanwhile"),
            findings_.count("readers stalled"));
  EXPECT_GE(findings_.count("points that finished meanwhile"), kFinishedMeanwhile * rounds);
  EXPECT_LE(most_mib_, kMostMiB);
  if (HoldsToTimes()) {
    EXPECT_LT(processor_.ratio() - 1, kMostLoss + 2 * processor_.StandardError());
    EXPECT_LT(processor_.StandardError(), kMostLoss) << "too noisy to tell";
  }
}

}  // namespace
}  // namespace ballpiston::torture
