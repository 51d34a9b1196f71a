#include "client/library/channel.h"
#include "client/library/client.h"
#include "server/convert/spec.h"
#include "tests/questions/engine.h"
#include "tests/support/server_process.h"

namespace ballpiston::questions {
namespace {

// One question to a server that runs.
class Conversation {
 public:
  Conversation(const Question& question, const ServerProcess& server, const client::Client& client)
      : question_(question), server_(server), client_(client) {}

  Report Have(double most_seconds) {
    const auto plan = client_.Plan(question_.spec);
    if (!plan.ok()) return Refused(plan.status());
    for (const v1::PointPlan& point : plan->points()) report_.Add(CheckPlan(point));
    report_.Add(CheckFinite(*plan));
    if (!report_.findings.empty()) {
      report_.outcome = "bad plan";
      return std::move(report_);
    }
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = question_.spec;
    request.set_fresh(true);
    const auto job = client_.Create(request);
    if (!job.ok()) return Failed(job.status());
    const auto end = AwaitEnd(job->name(), !(plan->work() <= most_seconds));
    if (!end.ok()) return Failed(end.status());
    Judge(*end);
    static_cast<void>(client_.Delete(job->name()));
    return std::move(report_);
  }

 private:
  // The server refuses what the engine refuses, with the same words.
  Report Refused(const absl::Status& status) {
    if (!absl::IsInvalidArgument(status)) return Failed(status);
    report_.outcome = "refused";
    const auto violations = server::CheckSpec(question_.spec).violations;
    if (violations.empty()) {
      // What this machine cannot do. The engine knows no machine.
      report_.outcome = "refused here";
      if (!absl::StrContains(status.message(), "permitted")) {
        report_.Add("refusal", absl::StrCat("does not say what is permitted: ", status.message()));
      }
    } else if (!absl::StrContains(status.message(), violations.front().description)) {
      report_.Add("refusal", absl::StrCat("not the engine's words: ", status.message()));
    }
    if (const auto job = client_.Create(question_.spec); job.ok()) {
      report_.Add("refusal", "planning is refused, and running is not");
      static_cast<void>(client_.Cancel(job->name()));
    }
    return std::move(report_);
  }

  void AddFailure(const absl::Status& status) {
    report_.outcome = "failed";
    report_.Add(kCallCheck, status.ToString());
  }

  Report Failed(const absl::Status& status) {
    AddFailure(status);
    return std::move(report_);
  }

  // Waits until the state is `wanted` or a call fails. Reports a finding if the server uses more
  // than kMostProcessorSeconds.
  template <typename Wanted>
  absl::StatusOr<v1::EnsembleJob> AwaitState(const std::string& name, Wanted wanted) {
    const double start = server_.ProcessorSeconds();
    absl::StatusOr<v1::EnsembleJob> job;
    bool takes_too_much = false;
    AwaitThat([&] {
      job = client_.Get(name);
      takes_too_much = job.ok() && server_.ProcessorSeconds() - start > kMostProcessorSeconds;
      return !job.ok() || wanted(job->state()) || takes_too_much;
    });
    if (job.ok() && !wanted(job->state())) {
      report_.Add(kEndCheck,
                  absl::StrCat("the job is ", v1::EnsembleJob::State_Name(job->state()), " after ",
                               kMostProcessorSeconds, " s of processor time"));
    }
    return job;
  }

  // The job at its end. If `is_long`, it is cancelled as soon as it runs.
  absl::StatusOr<v1::EnsembleJob> AwaitEnd(const std::string& name, bool is_long) {
    if (is_long) {
      const auto begun =
          AwaitState(name, [](auto state) { return state != v1::EnsembleJob::QUEUED; });
      const auto cancelled = begun.ok() ? client_.Cancel(name) : begun;
      if (!cancelled.ok() && !absl::IsFailedPrecondition(cancelled.status())) return cancelled;
    }
    return AwaitState(name, client::HasEnded);
  }

  void Judge(const v1::EnsembleJob& job) {
    report_.Add(CheckFinite(job));
    const v1::Target& target = question_.spec.target();
    const bool may_fail = target.has_tolerance() && target.has_budget();
    if (job.state() == v1::EnsembleJob::SUCCEEDED) {
      report_.outcome = "answered";
      JudgeResults(job);
    } else if (job.state() == v1::EnsembleJob::CANCELLED) {
      report_.outcome = "cancelled";
    } else if (job.state() == v1::EnsembleJob::FAILED) {
      report_.outcome = "failed";
      if (!may_fail) report_.Add("job", "the job failed: " + job.error().message());
    } else {
      report_.outcome = "no end";
    }
  }

  void JudgeResults(const v1::EnsembleJob& job) {
    const auto points = client_.Results(job.name());
    if (!points.ok()) {
      AddFailure(points.status());
      return;
    }
    if (static_cast<int>(points->size()) != job.progress().points()) {
      report_.Add("job",
                  absl::StrCat(points->size(), " results of ", job.progress().points(), " points"));
    }
    for (const v1::PointResult& point : *points) report_.Add(CheckAnswer(question_.spec, point));
  }

  const Question& question_;
  const ServerProcess& server_;
  const client::Client& client_;
  Report report_;
};

struct RunningServer {
  RunningServer() { process.Start(); }
  ServerProcess process;
  const client::Client client{*client::OpenChannel(process.address()), absl::FromChrono(kPatience)};
};

Report Ask(const Question& question, double most_seconds, std::unique_ptr<RunningServer>& server) {
  if (server == nullptr) server = std::make_unique<RunningServer>();
  Report report;
  try {
    report = Conversation(question, server->process, server->client).Have(most_seconds);
  } catch (const std::runtime_error& late) {  // tests/support/await.h
    report = {.outcome = "no end", .findings = {{kEndCheck, late.what()}}};
  }
  // A call may fail a little before the process has ended.
  const std::chrono::milliseconds patience(report.Breaks(kCallCheck) ? 5000 : 0);
  if (const auto code = server->process.AwaitEnd(patience)) {
    const std::string log = server->process.log();
    const std::string last = log.substr(log.size() - std::min<size_t>(log.size(), 600));
    report.outcome = "died";
    report.findings = {
        {"crash", absl::StrCat("the server ended with exit code ", *code, ": ", last)}};
    server.reset();
  } else if (report.Breaks(kEndCheck)) {
    server.reset();
  }
  return report;
}

}  // namespace

std::function<Report(const Question&)> ServerAsker(double most_seconds) {
  const auto server = std::make_shared<std::unique_ptr<RunningServer>>();
  return [=](const Question& question) { return Ask(question, most_seconds, *server); };
}

}  // namespace ballpiston::questions
