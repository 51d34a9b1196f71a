#include "tests/simulation/client.h"

#include "server/convert/spec.h"
#include "server/rpc/watch.h"
#include "server/store/job_name.h"
#include "server/store/job_record.h"
#include "tests/server/requests.h"

namespace ballpiston::server {
namespace {

constexpr uint64_t kKeys = 12, kSeedsWithoutKey = 6;
constexpr std::chrono::seconds kLongestRead(2);
constexpr std::chrono::milliseconds kHeartbeat(2000), kSnapshot(200);

// The probability that the client of a watch leaves when it gets a message.
constexpr double kLeaves = 0.05;

}  // namespace

// A call to the server that runs now.
class Client::Call {
 public:
  Call(ClientWorld& world, std::string what)
      : world_(world),
        what_(std::move(what)),
        life_(world.life()),
        troubles_(world.troubles()),
        began_in_trouble_(world.is_in_trouble()) {
    if (life_ != nullptr) world_.tell(absl::StrCat(what_, " ..."));
  }

  explicit operator bool() const { return life_ != nullptr; }
  Life* operator->() const { return life_.get(); }

  // False: the server died before it answered, or the call failed for a permitted reason.
  bool Hears(const absl::Status& status) {
    if (life_->is_over()) return false;
    world_.tell(absl::StrCat(what_, " -> ", status.ok() ? "OK" : status.ToString()));
    const bool is_refused = absl::IsUnavailable(status) || absl::IsResourceExhausted(status);
    if (!is_refused) return true;
    if (!began_in_trouble_ && troubles_ == world_.troubles()) {
      throw Violation("refused", "", absl::StrCat(what_, ": ", status.ToString()));
    }
    return false;
  }

 private:
  ClientWorld& world_;
  const std::string what_;
  const std::shared_ptr<Life> life_;
  const uint64_t troubles_;
  const bool began_in_trouble_;
};

void Client::CallOnce() {
  const std::vector<std::string> ids = world_.expectations.Ids();
  const uint64_t choice = world_.machine.Below(100);
  if (ids.empty() || choice < 20) return Create();
  if (choice < 35) return List();
  const std::string& id = ids[world_.machine.Below(ids.size())];
  if (choice < 52) return Get(id);
  if (choice < 55) return Update(id);
  if (choice < 70) return Read(id);
  if (choice < 85) return world_.habits.watches ? Watch(id) : Get(id);
  if (choice < 90) return world_.habits.cancels ? Cancel(id) : Get(id);
  return world_.habits.deletes ? Delete(id) : Get(id);
}

void Client::Create() {
  const bool has_key = world_.habits.retries && world_.machine.Chance(0.7);
  const Question question = QuestionOf(has_key ? kFirstKeyedSeed + world_.machine.Below(kKeys)
                                               : 1 + world_.machine.Below(kSeedsWithoutKey));
  const std::string key = question.has_key ? absl::StrCat("key-", question.seed) : "";
  v1::CreateEnsembleJobRequest request = CreateRequest(SpecOf(question), key);
  request.set_priority(static_cast<int32_t>(question.seed % 3) - 1);
  request.set_fresh(!question.has_key && world_.machine.Chance(0.5));
  const std::map<std::string, KnownJob> before = world_.expectations.all();
  Call call(world_, absl::StrCat("create ", question.seed, " ", key));
  if (!call) return;
  const auto job = call->book().Create(LocalPrincipal(), request, CheckSpec(SpecOf(question)));
  if (!call.Hears(job.status())) return;
  if (!job.ok()) throw Violation("create", "", job.status().ToString());
  world_.tell(absl::StrCat("created ", *JobIdOf(job->name())));
  world_.expectations.Created(before, key, question, *job);
}

void Client::Get(const std::string& id) {
  const KnownJob before = world_.expectations.Known(id);
  Call call(world_, absl::StrCat("get ", id));
  if (!call) return;
  const auto job = call->book().Get(LocalPrincipal(), id);
  if (!call.Hears(job.status())) return;
  if (absl::IsNotFound(job.status())) return world_.expectations.Missed(id);
  if (!job.ok()) throw Violation("get", id, job.status().ToString());
  world_.expectations.Got(before, *job);
}

void Client::List() {
  const std::map<std::string, KnownJob> before = world_.expectations.all();
  Call call(world_, "list");
  if (!call) return;
  const auto page =
      call->book().List(LocalPrincipal(), {.before = std::numeric_limits<int64_t>::max(),
                                           .max_jobs = 10'000,
                                           .max_bytes = std::numeric_limits<size_t>::max()});
  if (!call.Hears(page.status())) return;
  if (!page.ok()) throw Violation("list", "", page.status().ToString());
  world_.expectations.Listed(before, page->jobs);
}

void Client::Cancel(const std::string& id) {
  const KnownJob before = world_.expectations.Known(id);
  world_.expectations.AskedToCancel(id);
  Call call(world_, absl::StrCat("cancel ", id));
  if (!call) return;
  const auto job = call->book().Cancel(LocalPrincipal(), id, "");
  if (!call.Hears(job.status())) return;
  if (absl::IsNotFound(job.status())) return world_.expectations.Missed(id);
  if (absl::IsFailedPrecondition(job.status())) {
    return world_.expectations.CancelRefused(id);
  }
  if (!job.ok()) throw Violation("cancel", id, job.status().ToString());
  world_.expectations.Cancelled(id);
  world_.expectations.Got(before, *job);
}

void Client::Delete(const std::string& id) {
  const KnownJob before = world_.expectations.Known(id);
  world_.expectations.AskedToDelete(id);
  Call call(world_, absl::StrCat("delete ", id));
  if (!call) return;
  const absl::Status status = call->book().Delete(LocalPrincipal(), id);
  if (!call.Hears(status)) return;
  if (absl::IsNotFound(status)) return world_.expectations.Missed(id);
  if (absl::IsFailedPrecondition(status)) return world_.expectations.DeletionRefused(id, before);
  if (!status.ok()) throw Violation("delete", id, status.ToString());
  world_.expectations.Deleted(id);
}

void Client::Update(const std::string& id) {
  const KnownJob before = world_.expectations.Known(id);
  Call call(world_, absl::StrCat("update ", id));
  if (!call) return;
  JobChange change;
  if (world_.machine.Chance(0.5)) change.pinned = world_.machine.Chance(0.5);
  if (!change.pinned) change.priority = static_cast<int32_t>(world_.machine.Below(3)) - 1;
  const auto job = call->book().Update(LocalPrincipal(), id, change);
  if (!call.Hears(job.status())) return;
  if (absl::IsNotFound(job.status())) return world_.expectations.Missed(id);
  if (!job.ok()) throw Violation("update", id, job.status().ToString());
  world_.expectations.Got(before, *job);
}

void Client::Read(const std::string& id) {
  const KnownJob before = world_.expectations.Known(id);
  Call call(world_, absl::StrCat("results ", id));
  if (!call) return;
  const auto page = call->book().Results(
      LocalPrincipal(), id,
      {.max_points = 1000, .max_bytes = std::numeric_limits<size_t>::max(), .histograms = false});
  if (!call.Hears(page.status())) return;
  if (absl::IsNotFound(page.status())) return world_.expectations.Missed(id);
  if (!page.ok()) throw Violation("results", id, page.status().ToString());
  world_.expectations.Read(id, before, page->points);
}

// ---- watches ----

class Client::Reader : public WatchReader {
 public:
  Reader(ClientWorld& world, Call& call, std::string id, Chain& chain)
      : world_(world),
        call_(call),
        id_(std::move(id)),
        chain_(chain),
        before_(world.expectations.Known(id_)) {}

  const Principal& caller() const override { return caller_; }
  absl::Status Proceed() override {
    return call_->is_over() ? absl::UnavailableError("the server ends") : absl::OkStatus();
  }
  std::chrono::steady_clock::time_point next_check() const override {
    return world_.machine.now() + kHeartbeat;
  }
  int64_t watches() const override { return 1; }

  bool Write(const v1::WatchEnsembleJobResponse& message) override {
    world_.machine.Sleep(world_.machine.UpTo(kLongestRead));
    if (call_->is_over() || world_.machine.Chance(kLeaves)) return false;
    if (chain_.has_ended) throw Violation("watch", id_, "a message after the end");
    chain_.token = message.resume_token();
    for (const v1::PointResult& point : message.snapshot().finished_points()) {
      world_.tell(absl::StrCat("watch ", id_, ": point ", point.index()));
      chain_.points.push_back(point);
    }
    if (message.has_job()) {
      Progressed(message.job().progress());
      Saw(message.job().state());
    } else if (message.has_snapshot()) {
      Progressed(message.snapshot().progress());
    }
    world_.expectations.Watched(id_, chain_.points, state_);
    before_ = world_.expectations.Known(id_);  // of the next message
    return true;
  }

 private:
  // The progress that one watch sends never goes back.
  void Progressed(const v1::JobProgress& now) {
    if (now.points_done() < progress_.points_done() || now.samples() < progress_.samples()) {
      throw Violation(
          "progress", id_,
          absl::StrCat(now.ShortDebugString(), " after ", progress_.ShortDebugString()));
    }
    progress_ = now;
  }

  void Saw(v1::EnsembleJob::State state) {
    world_.tell(absl::StrCat("watch ", id_, ": ", v1::EnsembleJob::State_Name(state)));
    world_.expectations.Saw(id_, before_, state);
    state_ = state;
    chain_.has_ended = HasEnded(state);
  }

  ClientWorld& world_;
  Call& call_;
  const std::string id_;
  Chain& chain_;
  KnownJob before_;
  v1::JobProgress progress_;
  v1::EnsembleJob::State state_ = v1::EnsembleJob::QUEUED;
  const Principal caller_ = LocalPrincipal();
};

void Client::Watch(const std::string& id) {
  Call call(world_, absl::StrCat("watch ", id));
  if (!call) return;
  if (chains_[id].has_ended) chains_[id] = {};
  Reader reader(world_, call, id, chains_[id]);
  v1::WatchEnsembleJobRequest request;
  request.set_name(JobName(id));
  request.set_resume_token(chains_[id].token);
  const absl::Status status =
      RunWatch(call->book(), {.snapshot = kSnapshot, .heartbeat = kHeartbeat}, call->name(),
               request, reader);
  if (absl::IsCancelled(status) || !call.Hears(status)) return;
  if (absl::IsNotFound(status)) return world_.expectations.Missed(id);
  if (!status.ok()) throw Violation("watch", id, status.ToString());
  if (!chains_[id].has_ended) throw Violation("watch", id, "ended before the job");
}

}  // namespace ballpiston::server
