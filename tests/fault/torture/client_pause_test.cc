// For the client library a restart of the server is a short pause of a watch.
#include "client/library/channel.h"
#include "tests/fault/torture/questions.h"

namespace ballpiston::torture {
namespace {

using Clock = std::chrono::steady_clock;

// The longest pause between two attempts of the test's watch.
constexpr absl::Duration kMostBackoff = absl::Milliseconds(500);
// The longest time from a ready server to the watch's first message, without that pause.
constexpr double kMostSecondsToHear = 1;

TEST(ClientLibrary, WatchesAgainSoonAfterARestart) {
  Findings findings("client's pause");
  ConnectedServer server;
  server.Start();
  // The library's own channel: nothing else in this process hurries it.
  ASSERT_OK_AND_ASSIGN(const auto channel, client::OpenChannel(server.address()));
  const client::Client client(channel, absl::FromChrono(kPatience));
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleJob job, client.Create(Endless()));
  std::atomic<int> reports = 0;  // of the job: one at first, and one after each restart
  client::WatchCallbacks callbacks;
  callbacks.on_job = [&](const v1::EnsembleJob&) { ++reports; };
  client::WatchOptions options;
  options.max_backoff = kMostBackoff;
  options.give_up_after = absl::FromChrono(kPatience);
  auto watch =
      std::async(std::launch::async, [&] { return client.Watch(job.name(), callbacks, options); });
  // False if the watch has ended.
  const auto await_reports = [&](int count) {
    const auto has_ended = [&] {
      return watch.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    };
    AwaitThat([&] { return reports >= count || has_ended(); });
    return reports >= count;
  };
  await_reports(1);
  double longest = 0;
  for (int i = 0; i < Size(2, 20); ++i) {
    const int before = reports;
    server.Signal(i % 2 == 0 ? SIGKILL : SIGTERM);
    server.AwaitEnd();
    server.Start();
    const auto ready = Clock::now();
    EXPECT_TRUE(await_reports(before + 1)) << "the watch has ended";
    if (testing::Test::HasFailure()) break;
    longest = std::max(longest, std::chrono::duration<double>(Clock::now() - ready).count());
    findings.Count("restarts");
  }
  findings.Note("longest, seconds from ready to heard", absl::StrFormat("%.2f", longest));
  EXPECT_OK(client.Cancel(job.name()));
  EXPECT_OK(watch.get());
  if (HoldsToTimes()) {
    EXPECT_LT(longest, absl::ToDoubleSeconds(kMostBackoff) + kMostSecondsToHear);
  }
}

}  // namespace
}  // namespace ballpiston::torture
