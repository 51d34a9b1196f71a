// The frame of every call that is a stream. One write is in progress at a time, and the next
// message is made when that write is done.
//
// A slow reader therefore costs one message of memory, and no thread waits for it. The threads for
// streams make the messages, never gRPC's own threads. At most one Advance runs at a time. Only
// Advance writes messages and ends the stream.
//
// Once per heartbeat the stream checks its credentials again. It ends if they are no longer valid,
// also if its reader stalls.
#pragma once

#include <chrono>
#include <exception>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/support/server_callback.h"
#include "server/api/call.h"
#include "server/api/service_context.h"
#include "server/convert/errors.h"
#include "server/mutex.h"

namespace ballpiston::server {

template <typename Message>
class StreamReactor : public grpc::ServerWriteReactor<Message>,
                      public Watch,
                      public std::enable_shared_from_this<StreamReactor<Message>> {
 public:
  void OnWriteDone(bool ok) override {
    message_.Clear();  // frees its memory, because the next message may come much later
    ReleaseMessage();
    {
      MutexLock lock(mutex_);
      writing_ = false;
      cut_ = cut_ || !ok;
    }
    Schedule();
  }

  void OnCancel() override {
    {
      MutexLock lock(mutex_);
      cut_ = true;
    }
    Schedule();
  }

  void OnDone() override {
    ReleaseMessage();
    ReleaseCall();
    service_.watches.Remove(this);
    self_.reset();  // may delete this
  }

 protected:
  using Clock = std::chrono::steady_clock;

  StreamReactor(ServiceContext& service, grpc::CallbackServerContext& context)
      : service_(service),
        context_(context),
        active_(service.activity.Begin()),
        next_check_(Clock::now() + service.timing.heartbeat) {}

  // The reactor owns itself until gRPC calls OnDone. A call that was rejected ends at once.
  //   RESOURCE_EXHAUSTED  TOO_MANY_STREAMS
  void Start(const absl::StatusOr<Call>& call) {
    self_ = this->shared_from_this();
    absl::Status admitted = call.status();
    if (call.ok()) {
      caller_ = call->caller;
      admitted = service_.watches.Add(this, caller_.name, service_.limits);
    }
    if (admitted.ok()) {
      Schedule();
    } else {
      End(admitted);
    }
  }

  // ---- the messages of a stream ----

  // Writes the next message, or ends the stream, or does nothing if there is nothing to send now.
  // An error ends the stream. Advance calls this while no write is in progress.
  virtual absl::Status Tell() = 0;
  // Whether the caller, whose role may have changed, may still read the stream.
  virtual absl::Status CheckRights() const { return absl::OkStatus(); }
  // Releases the memory that was counted for a message, when it is written or the call ends.
  virtual void ReleaseMessage() {}
  virtual void ReleaseCall() {}

  // ---- when to send them ----

  // Requests a run of Advance. If Advance is running now, it runs once more.
  void Schedule() ABSL_LOCKS_EXCLUDED(mutex_) {
    {
      MutexLock lock(mutex_);
      if (ended_) return;
      again_ = scheduled_;
      if (std::exchange(scheduled_, true)) return;
    }
    service_.executor.PostOfStream(caller_.name,
                                   [self = this->shared_from_this()] { self->Advance(); });
  }

  // ---- for Tell ----

  void Write() ABSL_LOCKS_EXCLUDED(mutex_) {
    {
      MutexLock lock(mutex_);
      writing_ = true;
    }
    this->StartWrite(&message_);
  }

  void WriteLastAndEnd() ABSL_LOCKS_EXCLUDED(mutex_) {
    {
      MutexLock lock(mutex_);
      ended_ = true;
    }
    this->StartWriteAndFinish(&message_, grpc::WriteOptions(), grpc::Status::OK);
  }

  ServiceContext& service_;
  Principal caller_;  // its role may change
  Message message_;   // used by Tell, and by gRPC during a write

  Mutex mutex_;  // never held while gRPC is called
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;

 private:
  void Advance() {
    absl::Status told;
    try {
      told = Proceed();
    } catch (const std::exception& error) {
      told = WithReason(absl::InternalError(error.what()), "INTERNAL");
    }
    if (!told.ok()) End(told);
    bool once_more = false;
    {
      MutexLock lock(mutex_);
      scheduled_ = false;
      once_more = std::exchange(again_, false);
    }
    if (once_more) Schedule();
  }

  absl::Status Proceed() {
    bool writing = false;
    {
      MutexLock lock(mutex_);
      if (ended_) return absl::OkStatus();
      writing = writing_;
      if (!writing && !abandoned_.ok()) return abandoned_;
      if (!writing && cut_) return absl::CancelledError("the client is gone");
    }
    const absl::Status checked = CheckCaller();
    if (writing && !checked.ok()) AbandonWrite(checked);
    if (writing || !checked.ok()) return writing ? absl::OkStatus() : checked;
    if (service_.draining) return ShuttingDown();
    message_.Clear();
    return Tell();
  }

  // OK if the caller may still read the stream, or if the next check is not due yet. An
  // administrator who lost that role may still see their own jobs. The stream ends if the token now
  // belongs to another principal.
  absl::Status CheckCaller() {
    const Clock::time_point now = Clock::now();
    if (now < next_check_) return absl::OkStatus();
    {
      MutexLock lock(mutex_);
      next_check_ = now + service_.timing.heartbeat;
    }
    absl::StatusOr<Principal> caller = service_.authenticator.Authenticate(context_);
    if (!caller.ok()) return caller.status();
    if (caller->name != caller_.name) return CredentialsInvalid();
    caller_.role = caller->role;
    return CheckRights();
  }

  // Cancels a write whose reader stalls, because the stream could not end otherwise.
  void AbandonWrite(const absl::Status& why) ABSL_LOCKS_EXCLUDED(mutex_) {
    {
      MutexLock lock(mutex_);
      abandoned_ = why;
    }
    context_.TryCancel();  // the write ends
  }

  void End(const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_) {
    {
      MutexLock lock(mutex_);
      if (std::exchange(ended_, true)) return;
    }
    this->Finish(GrpcStatus(status));
  }

  grpc::CallbackServerContext& context_;  // valid until the end is sent
  const std::shared_ptr<void> active_;    // for Activity
  std::shared_ptr<StreamReactor> self_;

  bool scheduled_ ABSL_GUARDED_BY(mutex_) = false;
  bool again_ ABSL_GUARDED_BY(mutex_) = false;
  bool cut_ ABSL_GUARDED_BY(mutex_) = false;        // the client has disconnected
  absl::Status abandoned_ ABSL_GUARDED_BY(mutex_);  // why the write was cancelled

 protected:
  // Only Advance changes this, and it holds the lock then. So Advance may read it without the lock;
  // other functions need it.
  Clock::time_point next_check_;  // of the credentials
};

}  // namespace ballpiston::server
