#include "client/library/reattach_pace.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

const ReattachPace::Time kStart = ReattachPace::Time() + hours(1);

WatchOptions ThreeMinutes() {
  WatchOptions options;
  options.initial_backoff = absl::Seconds(1);
  options.max_backoff = absl::Seconds(4);
  options.give_up_after = absl::Minutes(3);
  return options;
}

TEST(ReattachPace, PausesDoubleUpToTheirMaximum) {
  const WatchOptions options = ThreeMinutes();
  ReattachPace pace(options, kStart);
  for (const double expected : {1, 2, 4, 4, 4, 4}) {
    const std::optional<absl::Duration> pause = pace.NextPause(kStart);
    ASSERT_TRUE(pause);
    EXPECT_GE(absl::ToDoubleSeconds(*pause), 0.999 * expected);
    EXPECT_LE(absl::ToDoubleSeconds(*pause), 1.251 * expected);
  }
}

TEST(ReattachPace, PausesStartAgainAfterAMessage) {
  const WatchOptions options = ThreeMinutes();
  ReattachPace pace(options, kStart);
  for (int i = 0; i < 5; ++i) pace.NextPause(kStart);
  pace.Heard(kStart);
  const std::optional<absl::Duration> pause = pace.NextPause(kStart);
  ASSERT_TRUE(pause);
  EXPECT_LE(*pause, absl::Seconds(1.251));
}

TEST(ReattachPace, APauseIsAsLongAsTheServerAsks) {
  const WatchOptions options = ThreeMinutes();
  ReattachPace pace(options, kStart);
  for (const double expected : {10, 10, 10}) {
    const std::optional<absl::Duration> pause = pace.NextPause(kStart, absl::Seconds(10));
    ASSERT_TRUE(pause);
    EXPECT_GE(absl::ToDoubleSeconds(*pause), expected);
    EXPECT_LE(absl::ToDoubleSeconds(*pause), 1.251 * expected);
  }
  EXPECT_FALSE(pace.NextPause(kStart, absl::Minutes(4)));
}

// A pause of 1 s to 1.25 s that begins after 178 s ends within 3 min. A pause that begins after 180
// s ends too late.
TEST(ReattachPace, GivesUpWhenTheNextAttemptWouldComeTooLate) {
  const WatchOptions options = ThreeMinutes();
  EXPECT_TRUE(ReattachPace(options, kStart).NextPause(kStart + seconds(178)));
  EXPECT_FALSE(ReattachPace(options, kStart).NextPause(kStart + seconds(180)));
}

TEST(ReattachPace, TheTimeToGiveUpStartsAgainWithEveryMessage) {
  const WatchOptions options = ThreeMinutes();
  ReattachPace pace(options, kStart);
  ReattachPace::Time now = kStart;
  for (int i = 0; i < 100; ++i) {
    now += minutes(2);
    ASSERT_TRUE(pace.NextPause(now)) << i;
    pace.Heard(now);
  }
  EXPECT_FALSE(pace.NextPause(now + minutes(3)));
}

}  // namespace
}  // namespace ballpiston::client
