#include "tests/questions/engine.h"

#include <sys/prctl.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_replace.h"
#include "core/ensemble/block_run.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "core/model_choice/sampling_cost.h"
#include "server/convert/plan.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "tests/core/model_choice/questions.h"

namespace ballpiston::questions {
namespace {

// A grid has at most this many points that are planned and computed.
constexpr size_t kMostPoints = 27;

class Asking {
 public:
  Asking(const Question& question, double most_seconds)
      : question_(question), most_seconds_(most_seconds) {}

  Report Ask() {
    if (IsRefused()) return std::move(report_);
    if (Plan() <= most_seconds_) {
      Answer();
    } else {
      Stop();
    }
    report_.Add(CheckAgreement(spec_, SomeMachine(), most_seconds_));
    return std::move(report_);
  }

 private:
  bool IsRefused() {
    const server::CheckedSpec checked = server::CheckSpec(question_.spec);
    spec_ = checked.spec;
    report_.Add(CheckRefusal(question_.spec, checked.violations));
    if (checked.violations.empty() && !question_.defect.empty()) {
      report_.Add("refusal", "is not refused, although " + question_.defect);
    }
    if (!checked.violations.empty()) {
      report_.outcome = "refused";
      return true;
    }
    std::vector<FieldViolation> here = MachineViolations(spec_, SomeMachine());
    if (here.empty()) return false;
    for (FieldViolation& violation : here) violation.field.insert(0, "spec.");
    report_.Add(CheckRefusal(question_.spec, here));
    report_.outcome = "refused here";
    return true;
  }

  // The planned processor time.
  double Plan() {
    double work = 0;
    for (size_t i = 0; i < std::min(PointCount(spec_), kMostPoints); ++i) {
      const PointParameters point = PointAt(spec_, i);
      ladders_.push_back(LadderFor(spec_, point, SomeMachine()));
      const v1::PointPlan plan = server::PointPlanMessage(point, ladders_.back());
      report_.Add(CheckPlan(plan));
      const v1::ModelPlan* const chosen = Chosen(plan);
      work += chosen == nullptr ? 0 : chosen->work();
    }
    return work;
  }

  // A budget becomes the number of samples that it is planned to give.
  EnsembleSpec SpecOfPoint(size_t i) const {
    if (!spec_.target.budget_seconds) return spec_;
    return WithSamples(spec_, ladders_[i].Chosen().samples.value_or(1));
  }

  double PlannedMemory(size_t i) const {
    const PointParameters point = PointAt(spec_, i);
    return MemoryOf(OnePointSpec(spec_, point, ladders_[i].answer.model), point, 1);
  }

  void Answer() {
    report_.outcome = "answered";
    for (size_t i = 0; i < ladders_.size(); ++i) {
      const PeakMemory peak;
      ComputedPoint computed = ComputePoint(SpecOfPoint(i), i, ladders_[i].answer);
      report_.Add(CheckMemory(PlannedMemory(i), peak.Bytes()));
      report_.Add(std::move(computed.findings));
      report_.Add(CheckAnswer(question_.spec, computed.result));
    }
  }

  void Stop() {
    report_.outcome = "stopped";
    const PeakMemory peak;
    StartAndStop(SpecOfPoint(0), 0, ladders_[0].answer);
    report_.Add(CheckMemory(PlannedMemory(0), peak.Bytes()));
  }

  const Question& question_;
  const double most_seconds_;
  EnsembleSpec spec_;
  std::vector<Ladder> ladders_;
  Report report_;
};

// Hands out all blocks, and asks for a pause at once.
class ImpatientQueue : public BlockQueue {
 public:
  explicit ImpatientQueue(LocalPoint& point) : point_(point) {}

  std::optional<Block> Next() override { return point_.NextBlock(); }
  void Done(const Block& block, BlockResult result) override {
    point_.Add(block, std::move(result));
  }
  bool Pause() override {
    stop_.request_stop();
    return true;
  }
  std::stop_token stop() const override { return stop_.get_token(); }

 private:
  LocalPoint& point_;
  std::stop_source stop_;
};

// ---- child processes ----

// A report as lines: the outcome, then check and text of each finding.
std::string Text(const Report& report) {
  std::string text = report.outcome;
  for (const Finding& finding : report.findings) {
    absl::StrAppend(&text, "\n", finding.check, "\n",
                    absl::StrReplaceAll(finding.what, {{"\n", " "}}));
  }
  return text;
}

Report ReportFromText(const std::string& text) {
  const std::vector<std::string> lines = absl::StrSplit(text, '\n');
  Report report = {.outcome = lines[0]};
  for (size_t i = 1; i + 1 < lines.size(); i += 2) {
    report.findings.push_back({lines[i], lines[i + 1]});
  }
  return report;
}

[[noreturn]] void SendReport(const std::function<Report()>& ask, const std::string& file) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit limit = {kMostProcessorSeconds, kMostProcessorSeconds + 1}, no_core = {0, 0};
  setrlimit(RLIMIT_CPU, &limit);
  setrlimit(RLIMIT_CORE, &no_core);
  WriteFile(file, Text(ask()));
  _exit(EXIT_SUCCESS);
}

Finding Death(int status) {
  if (status == 0) return {"crash", "no report"};
  if (!WIFSIGNALED(status)) return {"crash", absl::StrCat("exit code ", WEXITSTATUS(status))};
  if (WTERMSIG(status) != SIGXCPU) {
    return {"crash", absl::StrCat("signal ", strsignal(WTERMSIG(status)))};
  }
  return {kEndCheck, absl::StrCat("no end after ", kMostProcessorSeconds, " s of processor time")};
}

}  // namespace

ComputedPoint ComputePoint(const EnsembleSpec& spec, size_t index, const Answer& answer) {
  const auto point = PointExperiment::Create(spec, index, answer);
  const PointSummary summary = point->Summarize(FoldPoint(*point));
  return {server::WithDetails(server::ResultOf(index, *point, summary), server::DetailsOf(summary),
                              *spec.experiment),
          CheckFinite(summary)};
}

void StartAndStop(const EnsembleSpec& spec, size_t index, const Answer& answer) {
  const auto point = PointExperiment::Create(spec, index, answer);
  LocalPoint local(*point);
  ImpatientQueue queue(local);
  // A point without samples has no run.
  if (const auto run = point->StartRun(queue)) run->Advance();
}

double SamplesIn(double seconds, const EnsembleSpec& spec, size_t index, Model model,
                 const Machine& machine) {
  if (!TakesSamples(model)) return std::numeric_limits<double>::infinity();
  const PointParameters point = PointAt(spec, index);
  return CostOfSampling(OnePointSpec(spec, point, model), point, machine.rates)
      .SamplesIn(seconds, machine.workers);
}

EnsembleSpec WithSamples(EnsembleSpec spec, double samples) {
  const auto count =
      static_cast<int64_t>(std::clamp(samples, 1.0, static_cast<double>(kMaxSamples)));
  const std::string estimate = spec.target.estimate;
  spec.target = {.samples = count, .estimate = estimate};
  return spec;
}

Report AskEngine(const Question& question, double most_seconds) {
  return Asking(question, most_seconds).Ask();
}

Report InChild(const std::function<Report()>& ask) {
  const TemporaryFolder folder;
  const std::string file = folder.File("report");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::strerror(errno));
  if (child == 0) SendReport(ask, file);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  Report report = ReportFromText(Contents(file));
  if (status != 0 || report.outcome.empty()) {
    report.outcome = "died";
    report.findings.push_back(Death(status));
  }
  return report;
}

}  // namespace ballpiston::questions
