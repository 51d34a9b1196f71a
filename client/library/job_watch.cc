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

// Its client starts no server: the watch itself retries.
class JobWatch {
 public:
  JobWatch(const Client& client, const WatchCallbacks& callbacks, const WatchOptions& options,
           std::stop_token stop, const std::function<void()>& reconnect)
      : client_(client),
        callbacks_(callbacks),
        options_(options),
        stop_(std::move(stop)),
        reconnect_(reconnect) {}

  absl::StatusOr<v1::EnsembleJob> Follow(const std::string& name) {
    request_.set_name(name);
    while (true) {
      const absl::Status end = ReadStream();
      if (ended_) return *std::move(ended_);
      if (stop_.stop_requested()) return Stopped();
      if (!IsBrokenStream(end)) return end;
      if (absl::Status wait = WaitToReattach(end); !wait.ok()) return wait;
    }
  }

 private:
  static absl::Status Stopped() { return absl::CancelledError("the watch was stopped"); }

  absl::Status ReadStream() {
    v1::WatchEnsembleJobResponse message;
    const auto on_message = [&] {
      Handle(message);
      return true;
    };
    const absl::Status status =
        client_.Call(request_, message, on_message, absl::InfiniteDuration(), stop_);
    if (!status.ok()) return status;
    return absl::UnavailableError("the server ended the watch before the job's end");
  }

  void Handle(const v1::WatchEnsembleJobResponse& message) {
    if (ended_) return;  // nothing after the terminal state is shown
    pace_.Heard();
    if (!message.resume_token().empty()) request_.set_resume_token(message.resume_token());
    if (message.has_job()) HandleJob(message.job());
    if (message.has_snapshot() && callbacks_.on_snapshot)
      callbacks_.on_snapshot(message.snapshot());
  }

  void HandleJob(const v1::EnsembleJob& job) {
    if (HasEnded(job.state())) ended_ = job;
    if (callbacks_.on_job) callbacks_.on_job(job);
  }

  absl::Status WaitToReattach(const absl::Status& why) {
    const std::optional<absl::Duration> pause = pace_.NextPause(RetryDelay(why));
    if (!pause && absl::IsResourceExhausted(why)) return why;  // the server answers, but is busy
    if (!pause) {
      return absl::UnavailableError(absl::StrCat("gave up watching after ",
                                                 absl::FormatDuration(options_.give_up_after),
                                                 " without a connection: ", why.message()));
    }
    if (callbacks_.on_disconnect) callbacks_.on_disconnect(why, *pause);
    if (!Pause(*pause, stop_)) return Stopped();
    reconnect_();
    return absl::OkStatus();
  }

  const Client client_;
  const WatchCallbacks& callbacks_;
  const WatchOptions& options_;
  const std::stop_token stop_;
  const std::function<void()>& reconnect_;
  v1::WatchEnsembleJobRequest request_;
  std::optional<v1::EnsembleJob> ended_;
  ReattachPace pace_{options_};
};

}  // namespace

bool HasEnded(v1::EnsembleJob::State state) {
  return state == v1::EnsembleJob::SUCCEEDED || state == v1::EnsembleJob::FAILED ||
         state == v1::EnsembleJob::CANCELLED;
}

absl::StatusOr<v1::EnsembleJob> Client::Watch(const std::string& name,
                                              const WatchCallbacks& callbacks,
                                              const WatchOptions& options,
                                              std::stop_token stop) const {
  const auto reconnect = [&] {
    if (revival_) revival_().IgnoreError();  // the next attempt reports that there is no server
    AwaitConnection(*channel_, stop);
  };
  return JobWatch(Client(channel_), callbacks, options, stop, reconnect).Follow(name);
}

}  // namespace ballpiston::client
