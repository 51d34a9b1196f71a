// The processor time of the service beside that of its workers; and stalled readers, which use
// bounded memory in the server and no processor time.
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/stalled_watches.h"

namespace ballpiston::torture {
namespace {

constexpr double kMostMiB = 64;  // of all readers
constexpr double kMostOverhead = 0.01;
constexpr int kPoints = 40'000;  // many, so that the unread data is large
constexpr int kFinishedBefore = 600;
constexpr int kFinishedMeanwhile = 10;

// The processor time of all threads of the server, in excess of that of the workers and relative to
// it, while the workers work for so many seconds. Blocks that are being computed are not counted
// yet: some hundredths of a second. The engine alone in another program is no measure: its code has
// other addresses there, and takes up to 4 % more or less time.
double Overhead(const ServerProcess& server, const client::Client& client, const std::string& job,
                double seconds) {
  const auto work = [&] { return OrThrow(client.Get(job)).work(); };
  const double before = work(), start = server.ProcessorSeconds();
  double more = 0;
  AwaitThat([&] {
    // The pause is long because these requests take processor time, too.
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds / 20));
    more = work() - before;
    return more >= seconds;
  });
  return (server.ProcessorSeconds() - start) / more - 1;
}

std::string Percent(double share) { return absl::StrFormat("%+.2f %%", 100 * share); }

TEST(Overhead, OfTheServiceIsSmall) {
  Findings findings("overhead");
  for (const int workers : {1, 2}) {
    ConnectedServer server({.workers = workers});
    server.Start();
    const client::Client client = server.NewClient();
    const std::string job = OrThrow(client.Create(Endless())).name();
    const double overhead = Overhead(server, client, job, Size(1, 60));
    findings.Note(absl::StrCat("processor time beside that of workers: ", workers),
                  Percent(overhead));
    if (HoldsToTimes()) {
      EXPECT_LT(overhead, kMostOverhead);
    }
  }
}

TEST(StalledReaders, UseBoundedMemoryAndNoProcessorTime) {
  Findings findings("stalled readers");
  const int readers = Size(10, 250);
  const double seconds = Size(1, 60);
  ConnectedServer server;
  server.Start();
  const client::Client client = server.NewClient();
  const std::string job = OrThrow(client.Create(ManyPoints(kPoints, Size(3'000, 60'000)))).name();
  const auto finished = [&] { return OrThrow(client.Get(job)).progress().points_done(); };
  AwaitThat([&] { return finished() >= kFinishedBefore; });
  const double mib_without = server.ResidentMiB();
  const double quiet = Overhead(server, client, job, seconds);
  double overhead = 0, most_mib = 0;
  int silent = 0;  // readers that got no message meanwhile
  // If the server was too busy to send the readers enough in time, new readers get more time.
  for (std::chrono::milliseconds to_stall(Size(150, 2000)); silent < readers; to_stall *= 2) {
    ASSERT_LT(to_stall, kPatience) << "only " << silent << " readers have stalled";
    StalledWatches stalled(readers, server.address(), job);
    std::this_thread::sleep_for(to_stall);
    const int first = finished();
    overhead = Overhead(server, client, job, seconds);
    most_mib = std::max(most_mib, server.ResidentMiB() - mib_without);
    // Otherwise silence would prove nothing.
    AwaitThat([&] { return finished() >= first + kFinishedMeanwhile; });
    // A message made at either of the two moments may have either number.
    silent = stalled.CountSilent(first, finished());
  }
  findings.Count("readers stalled", readers);
  findings.Note("most memory of all, MiB", absl::StrFormat("%.1f", most_mib));
  findings.Note("processor time beside the workers'", Percent(overhead));
  findings.Note("the same without readers", Percent(quiet));
  EXPECT_LE(most_mib, kMostMiB);
  if (HoldsToTimes()) {
    EXPECT_LT(overhead - quiet, kMostOverhead);
  }
}

}  // namespace
}  // namespace ballpiston::torture
