#include "client/library/channel.h"
#include "client/library/client.h"
#include "server/convert/spec.h"
#include "tests/questions/questions.h"
#include "tests/support/server_process.h"

namespace ballpiston::questions {
namespace {

template <typename T>
T Answered(absl::StatusOr<T> answer) {
  Require(answer.ok(), kCallCheck, answer.status().ToString());
  return *std::move(answer);
}

// One question to a server that runs.
class Conversation {
 public:
  Conversation(const v1::EnsembleSpec& question, const ServerProcess& server,
               const client::Client& client)
      : question_(question), server_(server), client_(client) {}

  std::string Have(double most_seconds) {
    const auto planned = client_.Plan(question_);
    if (absl::IsInvalidArgument(planned.status())) return Refused(planned.status());
    const auto plan = Answered(planned);
    for (const v1::PointPlan& point : plan.points()) CheckPlan(point);
    CheckFinite(plan);
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = question_;
    request.set_fresh(true);
    const std::string name = Answered(client_.Create(request)).name();
    if (!(plan.work() <= most_seconds)) CancelWhenItRuns(name);
    const std::string outcome = Judged(AwaitState(name, client::HasEnded));
    const absl::Status deleted = client_.Delete(name);
    Require(deleted.ok(), kCallCheck, deleted.ToString());
    return outcome;
  }

 private:
  // The server refuses what the engine refuses, with the same words. Besides it refuses what its
  // machine cannot do: the engine knows no machine.
  std::string Refused(const absl::Status& status) {
    const auto violations = server::CheckSpec(question_).violations;
    const std::string words = violations.empty() ? "permitted" : violations.front().description;
    Require(absl::StrContains(status.message(), words), "refusal", "is not: ", words, " but ",
            status.message());
    const auto job = client_.Create(question_);
    if (job.ok()) static_cast<void>(client_.Cancel(job->name()));
    Require(!job.ok(), "refusal", "planning is refused, and running is not");
    Require(absl::IsInvalidArgument(job.status()), kCallCheck, job.status().ToString());
    return "refused";
  }

  // The job as soon as its state is `wanted`.
  template <typename Wanted>
  v1::EnsembleJob AwaitState(const std::string& name, Wanted wanted) {
    const double start = server_.ProcessorSeconds();
    v1::EnsembleJob job;
    AwaitThat([&] {
      job = Answered(client_.Get(name));
      if (wanted(job.state())) return true;
      Require(server_.ProcessorSeconds() - start <= kMostProcessorSeconds, kEndCheck, "the job is ",
              v1::EnsembleJob::State_Name(job.state()), " after ", kMostProcessorSeconds,
              " s of processor time");
      return false;
    });
    return job;
  }

  void CancelWhenItRuns(const std::string& name) {
    AwaitState(name, [](auto state) { return state != v1::EnsembleJob::QUEUED; });
    const auto cancelled = client_.Cancel(name);
    if (!absl::IsFailedPrecondition(cancelled.status())) Answered(cancelled);
  }

  std::string Judged(const v1::EnsembleJob& job) {
    CheckFinite(job);
    if (job.state() == v1::EnsembleJob::CANCELLED) return "cancelled";
    if (job.state() == v1::EnsembleJob::FAILED) {
      const v1::Target& target = question_.target();
      Require(target.has_tolerance() && target.has_budget(), "job",
              "the job failed: ", job.error().message());
      return "failed";
    }
    const auto points = Answered(client_.Results(job.name()));
    Require(static_cast<int>(points.size()) == job.progress().points(), "job", points.size(),
            " results of ", job.progress().points(), " points");
    for (const v1::PointResult& point : points) CheckAnswer(question_, point);
    return "answered";
  }

  const v1::EnsembleSpec& question_;
  const ServerProcess& server_;
  const client::Client& client_;
};

struct RunningServer {
  RunningServer() { process.Start(); }
  ServerProcess process;
  const client::Client client{*client::OpenChannel(process.address()), absl::FromChrono(kPatience)};
};

// Throws the violation again. If the server has died, throws a violation that reports the death.
[[noreturn]] void Rethrow(const Violation& broken, std::unique_ptr<RunningServer>& server) {
  // A call may fail a little before the process has ended.
  const std::chrono::milliseconds patience(broken.check == kCallCheck ? 5000 : 0);
  const auto code = server->process.AwaitEnd(patience);
  const std::string log = server->process.log();
  if (code || broken.check == kEndCheck) server.reset();
  if (!code) throw broken;
  throw Violation("crash",
                  absl::StrCat("the server ended with exit code ", *code, ": ",
                               log.substr(log.size() - std::min<size_t>(log.size(), 600))));
}

std::string Ask(const v1::EnsembleSpec& question, double most_seconds,
                std::unique_ptr<RunningServer>& server) {
  if (server == nullptr) server = std::make_unique<RunningServer>();
  try {
    std::string outcome =
        Conversation(question, server->process, server->client).Have(most_seconds);
    Require(!server->process.AwaitEnd({}), kCallCheck, "the server died after its last answer");
    return outcome;
  } catch (const Violation& broken) {
    Rethrow(broken, server);
  } catch (const std::runtime_error& late) {  // tests/support/await.h
    Rethrow(Violation(kEndCheck, late.what()), server);
  }
}

}  // namespace

std::function<std::string(const v1::EnsembleSpec&)> ServerAsker(double most_seconds) {
  const auto server = std::make_shared<std::unique_ptr<RunningServer>>();
  return [=](const v1::EnsembleSpec& question) { return Ask(question, most_seconds, *server); };
}

}  // namespace ballpiston::questions
