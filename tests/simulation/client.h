// A client that calls the server at random and compares each answer with the expectations.
#pragma once

#include "server/convert/spec.h"
#include "server/rpc/watch.h"
#include "server/store/job_name.h"
#include "server/store/job_record.h"
#include "tests/server/requests.h"
#include "tests/simulation/world.h"

namespace ballpiston::server {

class Client {
 public:
  explicit Client(World& world) : world_(world) {}

  // One call, of any kind. Throws Violation, as all calls do.
  void CallOnce() {
    const std::vector<std::string> ids = expectations_.Ids();
    const uint64_t choice = machine_.Below(100);
    if (ids.empty() || choice < 20) return Create();
    if (choice < 35) return List();
    const std::string& id = ids[machine_.Below(ids.size())];
    if (choice < 52) return Get(id);
    if (choice < 55) return Update(id);
    if (choice < 70) return Read(id);
    if (choice < 85) return Does(kWatches) ? Watch(id) : Get(id);
    if (choice < 90) return Does(kCancels) ? Cancel(id) : Get(id);
    return Does(kDeletes) ? Delete(id) : Get(id);
  }

  void List() {
    Call call(world_, "list");
    if (!call) return;
    const KnownJobs before = expectations_.all();
    const auto page =
        call->book().List(LocalPrincipal(), {.before = std::numeric_limits<int64_t>::max(),
                                             .max_jobs = 10'000,
                                             .max_bytes = std::numeric_limits<size_t>::max()});
    if (call.Succeeds(page.status())) expectations_.Listed(before, page->jobs);
  }

  void Read(const std::string& id) {
    Call call(world_, "results", id);
    if (!call) return;
    const auto page = call->book().Results(
        LocalPrincipal(), id,
        {.max_points = 1000, .max_bytes = std::numeric_limits<size_t>::max(), .histograms = false});
    if (call.Succeeds(page.status())) expectations_.Read(id, call.before, page->points);
  }

  void Delete(const std::string& id) {
    Call call(world_, "delete", id);
    if (!call) return;
    expectations_.AskedToDelete(id);
    const absl::Status status = call->book().Delete(LocalPrincipal(), id);
    const auto is_active = [&] { expectations_.DeletionRefused(id, call.before); };
    if (call.Succeeds(status, is_active)) expectations_.Deleted(id);
  }

  void Watch(const std::string& id) {
    Call call(world_, "watch", id);
    if (!call) return;
    Chain& chain = chains_[id];
    if (chain.has_ended) chain = {};
    Reader reader(world_, call, chain);
    v1::WatchEnsembleJobRequest request;
    request.set_name(JobName(id));
    request.set_resume_token(chain.token);
    const absl::Status status = RunWatch(
        call->book(), {.snapshot = std::chrono::milliseconds(200), .heartbeat = kHeartbeat},
        call->name, request, reader);
    if (absl::IsCancelled(status) || !call.Succeeds(status)) return;
    Require(chain.has_ended, "watch", id, "ended before the job");
  }

 private:
  static constexpr std::chrono::seconds kHeartbeat{2}, kLongestRead{2};

  // The probability that the client of a watch leaves when it gets a message.
  static constexpr double kLeaves = 0.05;

  // A watch and the watches that resume it.
  struct Chain {
    std::string token;
    std::vector<v1::PointResult> points;
    bool has_ended = false;
  };

  // A call that begins now, if there is a server.
  class Call {
   public:
    Call(World& world, const std::string& verb, const std::string& id = "")
        : id(id),
          before(world.expectations.Known(id)),
          world_(world),
          verb_(verb),
          life_(world.Server()),
          troubles_(world.troubles),
          began_in_trouble_(world.is_in_trouble) {
      if (life_ != nullptr) world_.Tell(absl::StrCat(verb_, " ", id, " ..."));
    }

    explicit operator bool() const { return life_ != nullptr; }
    Life* operator->() const { return life_.get(); }

    // Returns whether the call succeeded. Another answer is permitted if the server died first, if
    // calls may fail now, or if the job was deleted. FAILED_PRECONDITION is permitted only with
    // `if_precondition_fails`, which is then called.
    bool Succeeds(const absl::Status& status,
                  const std::function<void()>& if_precondition_fails = nullptr) {
      if (life_->is_over) return false;
      world_.Tell(absl::StrCat(verb_, " ", id, " -> ", status.ok() ? "OK" : status.ToString()));
      if (status.ok()) return true;
      const bool is_refused = absl::IsUnavailable(status) || absl::IsResourceExhausted(status);
      const bool may_be_refused = began_in_trouble_ || troubles_ != world_.troubles;
      Require(!is_refused || may_be_refused, "refused", "", verb_, " ", id, ": ",
              status.ToString());
      if (is_refused) return false;
      if (absl::IsNotFound(status) && !id.empty()) {
        world_.expectations.Missed(id);
      } else if (absl::IsFailedPrecondition(status) && if_precondition_fails) {
        if_precondition_fails();
      } else {
        throw Violation(verb_, id, status.ToString());
      }
      return false;
    }

    const std::string id;   // of the job; empty: of none
    const KnownJob before;  // what was known of it

   private:
    World& world_;
    const std::string verb_;
    const std::shared_ptr<Life> life_;
    const uint64_t troubles_;
    const bool began_in_trouble_;
  };

  class Reader : public WatchReader {
   public:
    Reader(World& world, Call& call, Chain& chain)
        : world_(world), call_(call), chain_(chain), before_(call.before) {}

    const Principal& caller() const override { return caller_; }
    absl::Status Proceed() override {
      return call_->is_over ? absl::UnavailableError("the server ends") : absl::OkStatus();
    }
    std::chrono::steady_clock::time_point next_check() const override {
      return world_.machine.now() + kHeartbeat;
    }
    int64_t watches() const override { return 1; }

    bool Write(const v1::WatchEnsembleJobResponse& message) override {
      world_.machine.Sleep(world_.machine.UpTo(kLongestRead));
      if (call_->is_over || world_.machine.Chance(kLeaves)) return false;
      Require(!chain_.has_ended, "watch", call_.id, "a message after the end");
      chain_.token = message.resume_token();
      for (const v1::PointResult& point : message.snapshot().finished_points()) {
        world_.Tell(absl::StrCat("watch ", call_.id, ": point ", point.index()));
        chain_.points.push_back(point);
      }
      if (message.has_job()) {
        Progressed(message.job().progress());
        Saw(message.job().state());
      } else if (message.has_snapshot()) {
        Progressed(message.snapshot().progress());
      }
      world_.expectations.Watched(call_.id, chain_.points, state_);
      before_ = world_.expectations.Known(call_.id);  // of the next message
      return true;
    }

   private:
    // The progress that one watch sends never goes back.
    void Progressed(const v1::JobProgress& now) {
      Require(now.points_done() >= progress_.points_done() && now.samples() >= progress_.samples(),
              "progress", call_.id, now.ShortDebugString(), " after ",
              progress_.ShortDebugString());
      progress_ = now;
    }

    void Saw(v1::EnsembleJob::State state) {
      world_.Tell(absl::StrCat("watch ", call_.id, ": ", v1::EnsembleJob::State_Name(state)));
      world_.expectations.Saw(call_.id, before_, state);
      state_ = state;
      chain_.has_ended = HasEnded(state);
    }

    World& world_;
    Call& call_;
    Chain& chain_;
    KnownJob before_;
    v1::JobProgress progress_;
    v1::EnsembleJob::State state_ = v1::EnsembleJob::QUEUED;
    const Principal caller_ = LocalPrincipal();
  };

  bool Does(Kind kind) const { return world_.options.happens[kind]; }

  void Create() {
    const bool has_key = Does(kRetries) && machine_.Chance(0.7);
    const Question question = QuestionOf(has_key ? kFirstKeyedSeed + machine_.Below(kKeys)
                                                 : 1 + machine_.Below(kSeedsWithoutKey));
    const std::string key = question.has_key ? absl::StrCat("key-", question.seed) : "";
    v1::CreateEnsembleJobRequest request = CreateRequest(SpecOf(question), key);
    request.set_priority(static_cast<int32_t>(question.seed % 3) - 1);
    request.set_fresh(!question.has_key && machine_.Chance(0.5));
    Call call(world_, "create");
    if (!call) return;
    world_.Tell(absl::StrCat("create: seed ", question.seed));
    const KnownJobs before = expectations_.all();
    const auto job = call->book().Create(LocalPrincipal(), request, CheckSpec(SpecOf(question)));
    if (!call.Succeeds(job.status())) return;
    world_.Tell(absl::StrCat("created ", *JobIdOf(job->name()), " of seed ", question.seed));
    expectations_.Named(before, question, *job);
  }

  void Get(const std::string& id) {
    Call call(world_, "get", id);
    if (!call) return;
    const auto job = call->book().Get(LocalPrincipal(), id);
    if (call.Succeeds(job.status())) expectations_.Got(call.before, *job);
  }

  void Cancel(const std::string& id) {
    Call call(world_, "cancel", id);
    if (!call) return;
    expectations_.AskedToCancel(id);
    const auto job = call->book().Cancel(LocalPrincipal(), id, "");
    if (!call.Succeeds(job.status(), [&] { expectations_.CancelRefused(id); })) return;
    expectations_.Cancelled(id);
    expectations_.Got(call.before, *job);
  }

  void Update(const std::string& id) {
    Call call(world_, "update", id);
    if (!call) return;
    JobChange change;
    if (machine_.Chance(0.5)) change.pinned = machine_.Chance(0.5);
    if (!change.pinned) change.priority = static_cast<int32_t>(machine_.Below(3)) - 1;
    const auto job = call->book().Update(LocalPrincipal(), id, change);
    if (call.Succeeds(job.status())) expectations_.Got(call.before, *job);
  }

  World& world_;
  Machine& machine_ = world_.machine;
  Expectations& expectations_ = world_.expectations;
  std::map<std::string, Chain> chains_;  // by job
};

}  // namespace ballpiston::server
