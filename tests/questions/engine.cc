#include <sys/prctl.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

#include "core/ensemble/block_run.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "core/model_choice/sampling_cost.h"
#include "server/convert/plan.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "tests/core/model_choice/questions.h"
#include "tests/questions/questions.h"

namespace ballpiston::questions {
namespace {

// A grid has at most this many points that are planned and computed.
constexpr size_t kMostPoints = 27;

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

// Starts the computation and stops it where the engine first asks whether to stop.
void StartAndStop(const EnsembleSpec& spec, size_t index, const Answer& answer) {
  const auto point = PointExperiment::Create(spec, index, answer);
  LocalPoint local(*point);
  ImpatientQueue queue(local);
  // A point without samples has no run.
  if (const auto run = point->StartRun(queue)) run->Advance();
}

void AnswerPoint(const v1::EnsembleSpec& question, EnsembleSpec spec, size_t index,
                 const Ladder& ladder, bool is_short) {
  const PointParameters point = PointAt(spec, index);
  const double planned = MemoryOf(OnePointSpec(spec, point, ladder.answer.model), point, 1);
  // A budget becomes the number of samples that it is planned to give.
  if (spec.target.budget_seconds) spec = WithSamples(spec, ladder.Chosen().samples.value_or(1));
  const PeakMemory peak;
  v1::PointResult result;
  if (is_short) {
    result = ComputePoint(spec, index, ladder.answer);
  } else {
    StartAndStop(spec, index, ladder.answer);
  }
  CheckMemory(planned, peak.Bytes());
  if (is_short) CheckAnswer(question, result);
}

// ---- child processes ----

// Writes the outcome to the file, or the broken rule in the first line and its description below.
[[noreturn]] void Report(const std::function<std::string()>& ask, const std::string& file) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit limit = {kMostProcessorSeconds, kMostProcessorSeconds + 1}, no_core = {0, 0};
  setrlimit(RLIMIT_CPU, &limit);
  setrlimit(RLIMIT_CORE, &no_core);
  try {
    WriteFile(file, ask());
  } catch (const Violation& broken) {
    WriteFile(file, absl::StrCat(broken.check, "\n", broken.what()));
  }
  _exit(EXIT_SUCCESS);
}

Violation Death(int status) {
  if (status == 0) return {"crash", "no report"};
  if (!WIFSIGNALED(status)) return {"crash", absl::StrCat("exit code ", WEXITSTATUS(status))};
  if (WTERMSIG(status) != SIGXCPU) {
    return {"crash", absl::StrCat("signal ", strsignal(WTERMSIG(status)))};
  }
  return {kEndCheck, absl::StrCat("no end after ", kMostProcessorSeconds, " s of processor time")};
}

}  // namespace

v1::PointResult ComputePoint(const EnsembleSpec& spec, size_t index, const Answer& answer) {
  const auto point = PointExperiment::Create(spec, index, answer);
  const PointSummary summary = point->Summarize(FoldPoint(*point));
  CheckFinite(summary);
  return server::WithDetails(server::ResultOf(index, *point, summary), server::DetailsOf(summary),
                             *spec.experiment);
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

std::string AskEngine(const v1::EnsembleSpec& question, double most_seconds) {
  server::CheckedSpec checked = server::CheckSpec(question);
  const EnsembleSpec& spec = checked.spec;
  if (checked.violations.empty()) {
    server::AddViolations(MachineViolations(spec, SomeMachine()), checked);
  }
  CheckRefusal(question, checked.violations);
  if (!checked.violations.empty()) return "refused";
  std::vector<Ladder> ladders;
  double work = 0;
  for (size_t i = 0; i < std::min(PointCount(spec), kMostPoints); ++i) {
    const PointParameters point = PointAt(spec, i);
    ladders.push_back(LadderFor(spec, point, SomeMachine()));
    work += CheckPlan(server::PointPlanMessage(point, ladders.back()));
  }
  const bool is_short = work <= most_seconds;
  if (!is_short) ladders.resize(1);
  for (size_t i = 0; i < ladders.size(); ++i) AnswerPoint(question, spec, i, ladders[i], is_short);
  CheckAgreement(spec, SomeMachine(), most_seconds);
  return is_short ? "answered" : "stopped";
}

std::string InChild(const std::function<std::string()>& ask) {
  const TemporaryFolder folder;
  const std::string file = folder.File("report");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::strerror(errno));
  if (child == 0) Report(ask, file);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string report = Contents(file);
  if (status != 0 || report.empty()) throw Death(status);
  const std::vector<std::string> parts = absl::StrSplit(report, absl::MaxSplits('\n', 1));
  if (parts.size() > 1) throw Violation(parts[0], parts[1]);
  return report;
}

}  // namespace ballpiston::questions
