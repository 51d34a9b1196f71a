#include "client/library/job_watch.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/random/random.h"
#include "absl/strings/str_cat.h"
#include "client/library/client.h"
#include "client/library/error_text.h"

namespace ballpiston::client {
namespace {

// Sleeps for `length`. Returns false if `stop` ended the pause early.
bool Pause(absl::Duration length, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  woken.wait_for(lock, stop, absl::ToChronoNanoseconds(length), [] { return false; });
  return !stop.stop_requested();
}

// If a stream reaches a server that is just stopping, gRPC ends the stream with CANCELLED and no
// reason. A busy server refuses a stream with RESOURCE_EXHAUSTED and a reason.
bool IsBrokenStream(const absl::Status& end) {
  const bool has_reason = !ErrorReason(end).empty();
  return absl::IsUnavailable(end) || (absl::IsCancelled(end) && !has_reason) ||
         (absl::IsResourceExhausted(end) && has_reason);
}

// When a watch that lost its server retries, and when it gives up. Each pause is up to a quarter
// longer at random, so that the watchers of a restarted server do not all reconnect at the same
// moment.
class ReattachPace {
 public:
  explicit ReattachPace(const WatchOptions& options) : options_(options) { Heard(); }

  // The watch received a message: the pauses and the time until it gives up start again.
  void Heard() {
    lost_.reset();
    backoff_ = options_.initial_backoff;
  }

  // The pause before the next attempt, at least `least`; empty if it would end after the time to
  // give up.
  std::optional<absl::Duration> NextPause(absl::Duration least) {
    const absl::Duration pause = std::max(backoff_, least) * absl::Uniform(random_, 1.0, 1.25);
    backoff_ = std::min(2 * backoff_, options_.max_backoff);
    if (!lost_) lost_ = Clock::now();
    const absl::Duration silence = absl::FromChrono(Clock::now() - *lost_);
    if (silence + pause > options_.give_up_after) return std::nullopt;
    return pause;
  }

 private:
  using Clock = std::chrono::steady_clock;

  const WatchOptions& options_;
  // When the stream broke. Not the last message: this process itself may have slept since then.
  std::optional<Clock::time_point> lost_;
  absl::Duration backoff_;
  absl::InsecureBitGen random_;
};

// gRPC checks only every 5 s whether a channel has reconnected, unless a caller waits for it.
constexpr absl::Duration kLongestConnecting = absl::Seconds(1);
constexpr absl::Duration kLookForStop = absl::Milliseconds(50);

void AwaitConnection(grpc::ChannelInterface& channel, const std::stop_token& stop) {
  const absl::Time limit = absl::Now() + kLongestConnecting;
  while (!stop.stop_requested() && absl::Now() < limit) {
    if (channel.WaitForConnected(absl::ToChronoTime(absl::Now() + kLookForStop))) return;
  }
}

// The error of a watch that gives up. If the server was busy, returns the server's own error.
absl::Status GaveUp(const absl::Status& why, const WatchOptions& options) {
  if (absl::IsResourceExhausted(why)) return why;
  return absl::UnavailableError(absl::StrCat("gave up watching after ",
                                             absl::FormatDuration(options.give_up_after),
                                             " without a connection: ", why.message()));
}

}  // namespace

bool HasEnded(v1::EnsembleJob::State state) {
  return state == v1::EnsembleJob::SUCCEEDED || state == v1::EnsembleJob::FAILED ||
         state == v1::EnsembleJob::CANCELLED;
}

absl::StatusOr<v1::EnsembleJob> Client::Watch(const std::string& name,
                                              const WatchCallbacks& callbacks,
                                              const WatchOptions& options,
                                              std::stop_token stop) const {
  const Client single(channel_);  // it starts no server: the watch itself retries
  v1::WatchEnsembleJobRequest request;
  request.set_name(name);
  v1::WatchEnsembleJobResponse message;
  std::optional<v1::EnsembleJob> ended;
  ReattachPace pace(options);
  const auto on_message = [&] {
    if (ended) return true;  // nothing after the terminal state is shown
    pace.Heard();
    if (!message.resume_token().empty()) request.set_resume_token(message.resume_token());
    if (message.has_job() && HasEnded(message.job().state())) ended = message.job();
    if (message.has_job() && callbacks.on_job) callbacks.on_job(message.job());
    if (message.has_snapshot() && callbacks.on_snapshot) callbacks.on_snapshot(message.snapshot());
    return true;
  };
  const absl::Status stopped = absl::CancelledError("the watch was stopped");
  while (true) {
    absl::Status end = single.Call(request, message, on_message, absl::InfiniteDuration(), stop);
    end.Update(absl::UnavailableError("the server ended the watch before the job's end"));
    if (ended) return *std::move(ended);
    if (stop.stop_requested()) return stopped;
    if (!IsBrokenStream(end)) return end;
    const std::optional<absl::Duration> pause = pace.NextPause(RetryDelay(end));
    if (!pause) return GaveUp(end, options);
    if (callbacks.on_disconnect) callbacks.on_disconnect(end, *pause);
    if (!Pause(*pause, stop)) return stopped;
    if (revival_) revival_().IgnoreError();  // the next attempt reports that there is no server
    AwaitConnection(*channel_, stop);
  }
}

}  // namespace ballpiston::client
