#include "server/api/streams.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

// A stream has stalled if its check of credentials is overdue by this time.
constexpr std::chrono::seconds kGrace(1);

bool IsFull(int64_t streams, int64_t limit) { return limit != 0 && streams >= limit; }

absl::Status TooManyStreams(const std::string& what, const std::string& flag, int64_t limit) {
  return LimitExceeded("TOO_MANY_STREAMS", absl::StrCat(what, " open streams"), flag,
                       static_cast<double>(limit));
}

}  // namespace

Stream::Stream(Streams& all, grpc::ServerContext& context, Principal caller)
    : all_(all),
      context_(context),
      caller_(std::move(caller)),
      name_(caller_.name),
      next_check_(Clock::now() + all.heartbeat_) {}

Stream::~Stream() {
  MutexLock lock(all_.mutex_);
  all_.streams_.erase(this);
  all_.size_ = all_.streams_.size();
}

absl::Status Stream::Proceed() {
  if (context_.IsCancelled()) return absl::CancelledError("the client is gone");
  const Clock::time_point now = Clock::now();
  if (now >= next_check()) {
    absl::StatusOr<Principal> caller = all_.Authenticate(*this);
    if (!caller.ok()) return caller.status();
    caller_ = *std::move(caller);
    next_check_ = now + all_.heartbeat_;
  }
  return all_.draining_ ? ShuttingDown() : absl::OkStatus();
}

Streams::Streams(const Limits& limits, const Authenticator& authenticator,
                 std::chrono::milliseconds heartbeat, const std::atomic<bool>& draining)
    : limits_(limits), authenticator_(authenticator), heartbeat_(heartbeat), draining_(draining) {}

absl::Status Streams::Add(Stream& stream) {
  MutexLock lock(mutex_);
  const auto all = static_cast<int64_t>(streams_.size());
  if (IsFull(all, limits_.max_streams)) {
    return TooManyStreams(absl::StrCat("there are ", all), "max-streams", limits_.max_streams);
  }
  const int64_t own = CountOf(stream.name_);
  if (IsFull(own, limits_.max_streams_per_principal)) {
    return TooManyStreams(absl::StrCat(stream.name_, " has ", own), "max-streams-per-principal",
                          limits_.max_streams_per_principal);
  }
  streams_.insert(&stream);
  size_ = streams_.size();
  return absl::OkStatus();
}

int64_t Streams::CountOf(const std::string& principal) const {
  return std::count_if(streams_.begin(), streams_.end(),
                       [&](const Stream* stream) { return stream->name_ == principal; });
}

std::map<std::string, int64_t> Streams::ByPrincipal() const {
  MutexLock lock(mutex_);
  std::map<std::string, int64_t> streams;
  for (const Stream* stream : streams_) ++streams[stream->name_];
  return streams;
}

// The token may now belong to another principal.
absl::StatusOr<Principal> Streams::Authenticate(const Stream& stream) const {
  absl::StatusOr<Principal> caller = authenticator_.Authenticate(stream.context_);
  if (caller.ok() && caller->name != stream.name_) return CredentialsInvalid();
  return caller;
}

void Streams::EndRevoked() {
  MutexLock lock(mutex_);
  const auto now = Stream::Clock::now();
  for (Stream* stream : streams_) {
    const bool is_stalled = now >= stream->next_check() + kGrace;
    if (is_stalled && !Authenticate(*stream).ok()) stream->context_.TryCancel();
  }
}

}  // namespace ballpiston::server
