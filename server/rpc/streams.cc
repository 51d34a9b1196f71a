#include "server/rpc/streams.h"

#include <utility>

#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

// A stream has stalled if its check of credentials is overdue by this time.
constexpr std::chrono::seconds kGrace(1);

}  // namespace

void Streams::EndRevoked() {
  MutexLock lock(mutex_);
  const auto now = Stream::Clock::now();
  for (Stream* stream : streams_) {
    const bool is_stalled = now >= stream->next_check() + kGrace;
    if (is_stalled && !stream->Authenticate().ok()) stream->context_.TryCancel();
  }
}

Stream::Stream(Streams& all, grpc::ServerContext& context, Principal caller)
    : all_(all),
      context_(context),
      caller_(std::move(caller)),
      name_(caller_.name),
      next_check_(Clock::now() + all.heartbeat_) {
  MutexLock lock(all_.mutex_);
  all_.streams_.insert(this);
}

Stream::~Stream() {
  MutexLock lock(all_.mutex_);
  all_.streams_.erase(this);
}

absl::Status Stream::Proceed() {
  if (context_.IsCancelled()) return absl::CancelledError("the client is gone");
  const Clock::time_point now = Clock::now();
  if (now >= next_check()) {
    absl::StatusOr<Principal> caller = Authenticate();
    if (!caller.ok()) return caller.status();
    caller_ = *std::move(caller);
    next_check_ = now + all_.heartbeat_;
  }
  return all_.draining_ ? ShuttingDown() : absl::OkStatus();
}

// The token may now belong to another principal.
absl::StatusOr<Principal> Stream::Authenticate() const {
  absl::StatusOr<Principal> caller = all_.authenticator_.Authenticate(context_);
  if (caller.ok() && caller->name != name_) return CredentialsInvalid();
  return caller;
}

}  // namespace ballpiston::server
