// The server stays healthy with a thousand watchers of one job, and stops in time.
#include <list>

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "client/library/job_watch.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/stalled_watches.h"
#include "tests/server/calls.h"

namespace ballpiston::torture {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMostHealthSeconds = 0.05;
constexpr size_t kConnectionsOfWatchers = 10;
constexpr double kDrainSeconds = 1;

// A watch without a thread of its own.
class LiveWatcher : public grpc::ClientReadReactor<v1::WatchEnsembleJobResponse> {
 public:
  LiveWatcher(v1::EnsembleService::Stub& stub, const std::string& job) {
    request_.set_name(job);
    context_.set_deadline(std::chrono::system_clock::now() + kPatience);
    stub.async()->WatchEnsembleJob(&context_, &request_, this);
    StartRead(&message_);
    StartCall();
  }

  void OnReadDone(bool ok) override {
    if (!ok) return;
    ++heard_;
    if (message_.has_job() && client::HasEnded(message_.job().state())) ++ends_;
    StartRead(&message_);
  }
  void OnDone(const grpc::Status& status) override { done_.set_value(status.error_code()); }

  grpc::StatusCode AwaitEnd() { return done_.get_future().get(); }
  int heard() const { return heard_; }
  int ends() const { return ends_; }

 private:
  grpc::ClientContext context_;
  v1::WatchEnsembleJobRequest request_;
  v1::WatchEnsembleJobResponse message_;
  std::atomic<int> heard_ = 0, ends_ = 0;
  std::promise<grpc::StatusCode> done_;
};

// The 99th percentile of the seconds of many checks of the server's health, one every few
// milliseconds.
double HealthP99(const std::shared_ptr<grpc::Channel>& channel, int checks) {
  std::vector<double> seconds;
  for (int i = 0; i < checks; ++i) {
    const auto start = Clock::now();
    EXPECT_OK(server::CallByName(channel, server::kCheckHealth));
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[static_cast<size_t>(0.99 * static_cast<double>(seconds.size() - 1))];
}

// Creates jobs until the server rejects one; returns how many it accepted.
int FillQueue(const client::Client& client) {
  v1::EnsembleSpec spec = Endless();
  for (int taken = 0;; ++taken) {
    spec.set_seed(static_cast<uint64_t>(1'000 + taken));
    const auto job = client.Create(spec);
    if (job.ok()) continue;
    EXPECT_THAT(job, StatusIs(absl::StatusCode::kResourceExhausted));
    return taken;
  }
}

class LiveWatchers : public testing::Test {
 protected:
  void Start(double drain_seconds) {
    server_.emplace(
        ServerSetUp{.flags = {absl::StrFormat("--max-active-jobs-per-principal=%d", queue_),
                              absl::StrFormat("--drain-seconds=%g", drain_seconds)}});
    server_->Start();
    for (size_t i = 0; i < kConnectionsOfWatchers; ++i) {
      stubs_.push_back(v1::EnsembleService::NewStub(server_->Connect()));
    }
  }

  void Attach(int count, const std::string& job) {
    for (int i = 0; i < count; ++i) {
      watchers_.emplace_back(*stubs_[static_cast<size_t>(i) % kConnectionsOfWatchers], job);
    }
  }

  // Waits until each watcher has received this many messages.
  void AwaitHeard(int messages) const {
    for (const LiveWatcher& watcher : watchers_) {
      AwaitThat([&] { return watcher.heard() >= messages; });
    }
  }

  void CheckEnds() {
    for (LiveWatcher& watcher : watchers_) {
      EXPECT_EQ(watcher.AwaitEnd(), grpc::StatusCode::OK);
      EXPECT_EQ(watcher.ends(), 1);
      findings_.Count("terminal messages, then OK", watcher.ends());
      findings_.Count("messages", watcher.heard());
    }
  }

  // From SIGTERM to the process's end.
  double SecondsToStop(const std::string& clients) {
    const auto start = Clock::now();
    EXPECT_EQ(server_->Stop(), 0);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    findings_.Note("seconds to stop, " + clients, absl::StrFormat("%.2f", seconds));
    return seconds;
  }

  double Health(const std::string& when) {
    const double p99 = HealthP99(server_->Connect(), Size(10, 2000));
    findings_.Note("health p99, ms, " + when, absl::StrFormat("%.1f", 1e3 * p99));
    return p99;
  }

  const int queue_ = Size(100, 1000);  // its length
  Findings findings_{"live watchers"};
  std::optional<ConnectedServer> server_;
  std::vector<std::unique_ptr<v1::EnsembleService::Stub>> stubs_;
  std::list<LiveWatcher> watchers_;
};

TEST_F(LiveWatchers, AllGetTheEndAndHealthAnswersWithAFullQueue) {
  Start(kDrainSeconds);
  const client::Client client = server_->NewClient();
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleJob job, client.Create(Endless()));
  Attach(Size(100, 1000), job.name());
  AwaitHeard(3);
  findings_.Count("watchers at once", static_cast<int64_t>(watchers_.size()));
  Health("one job, all watching");
  EXPECT_EQ(FillQueue(client), queue_ - 1);
  findings_.Count("jobs in the full queue", queue_);
  const double p99 = Health("a full queue, all watching");
  ASSERT_OK(client.Cancel(job.name()));
  CheckEnds();
  if (HoldsToTimes()) {
    EXPECT_LT(p99, kMostHealthSeconds);
  }
}

TEST_F(LiveWatchers, LetAServerStopBeforeItsDrainTime) {
  Start(3600);
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleJob job, server_->NewClient().Create(Endless()));
  Attach(Size(100, 1000), job.name());
  AwaitHeard(1);
  const double seconds = SecondsToStop("live watchers");
  for (LiveWatcher& watcher : watchers_) {
    EXPECT_EQ(watcher.AwaitEnd(), grpc::StatusCode::UNAVAILABLE);  // not at its deadline
  }
  if (HoldsToTimes()) {
    EXPECT_LT(seconds, kDrainSeconds);
  }
}

// The server waits for them until its time to drain is over.
TEST_F(LiveWatchers, DelayTheStopByTheDrainAtMostIfTheyStall) {
  Start(kDrainSeconds);
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleJob job,
                       server_->NewClient().Create(ManyPoints(20'000, 1'000)));
  const StalledWatches stalled(20, server_->address(), job.name());
  const double seconds = SecondsToStop("stalled watchers");
  if (HoldsToTimes()) {
    EXPECT_LT(seconds, kDrainSeconds + 1);
  }
}

}  // namespace
}  // namespace ballpiston::torture
