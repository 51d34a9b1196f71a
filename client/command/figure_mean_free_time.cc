// The paper's figure of mean free times: two jobs and the closed forms.
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/create_job.h"
#include "client/command/figures.h"
#include "client/command/follow_job.h"
#include "client/command/number_list.h"
#include "client/command/violations.h"
#include "client/figure/mean_free_time_figure.h"
#include "client/library/analytic_client.h"
#include "client/library/ensemble_client.h"

namespace ballpiston::client {
namespace {

// Asks the server; one job after the other, so that Ctrl-C speaks of one.
class Asker {
 public:
  Asker(const FigureTools& tools, const Connection& connection)
      : tools_(tools), connection_(connection), client_(connection.channel) {}

  // The points of a job that succeeded. `*end` tells how it ended otherwise.
  absl::StatusOr<std::vector<v1::PointResult>> Measure(const v1::EnsembleSpec& spec,
                                                       ExitCode& end) const {
    const absl::StatusOr<v1::EnsembleJob> job = CreateJob(connection_, spec);
    if (!job.ok()) return job.status();
    std::ostream& err = tools_.terminal.err;
    const auto ended = FollowJob(connection_, job->name(), tools_.style, tools_.interrupts, err);
    if (!ended.ok()) return ended.status();
    end = ended->has_value() ? ReportEnd(**ended, err) : ExitCode::kInterrupted;
    if (end != ExitCode::kDone) return std::vector<v1::PointResult>();
    return client_.Results(job->name(), v1::ListResultsRequest::BASIC);
  }

  absl::StatusOr<v1::EvaluatePairsResponse> Evaluate(
      const v1::EvaluatePairsRequest& request) const {
    const AnalyticClient client(connection_.channel);
    return connection_.Ask([&] { return client.EvaluatePairs(request); });
  }

 private:
  const FigureTools& tools_;
  const Connection& connection_;
  const EnsembleClient client_;
};

absl::Status Evaluate(const Asker& asker, const MeanFreeTimeQuestion& question,
                      MeanFreeTimeAnswers& answers) {
  absl::StatusOr<v1::EvaluatePairsResponse> scale = asker.Evaluate(ScaleRequest(question));
  if (!scale.ok()) return scale.status();
  if (scale->points().empty()) return absl::InternalError("the server evaluated no closed forms");
  const double bound = scale->points(0).pair_delta_bound();
  absl::StatusOr<v1::EvaluatePairsResponse> curve = asker.Evaluate(CurveRequest(question, bound));
  if (!curve.ok()) return curve.status();
  answers.scale = *std::move(scale);
  answers.curve = *std::move(curve);
  return absl::OkStatus();
}

// How the first job that did not succeed ended, else kDone.
absl::StatusOr<ExitCode> Measure(const Asker& asker, const MeanFreeTimeQuestion& question,
                                 MeanFreeTimeAnswers& answers) {
  ExitCode end = ExitCode::kDone;
  auto conditional = asker.Measure(ConditionalSpec(question), end);
  if (!conditional.ok() || end != ExitCode::kDone)
    return conditional.ok() ? end : absl::StatusOr<ExitCode>(conditional.status());
  auto equilibrium = asker.Measure(EquilibriumSpec(question), end);
  if (!equilibrium.ok()) return equilibrium.status();
  answers.conditional = *std::move(conditional);
  answers.equilibrium = *std::move(equilibrium);
  return end;
}

absl::Status Write(const MeanFreeTimeFiles& files, const FigureTools& tools) {
  const std::pair<const char*, const std::string&> contents[] = {{".csv", files.measured_csv},
                                                                 {"-inset.csv", files.inset_csv},
                                                                 {"-exact.csv", files.exact_csv},
                                                                 {".gnuplot", files.script}};
  for (const auto& [suffix, content] : contents) {
    const std::string name = absl::StrCat(kMeanFreeTimeFigure, suffix);
    if (absl::Status status = tools.folder.Write(name, content, tools.terminal); !status.ok())
      return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<ExitCode> Make(const MeanFreeTimeQuestion& question, const FigureTools& tools,
                              const Connection& connection) {
  const Asker asker(tools, connection);
  MeanFreeTimeAnswers answers;
  if (absl::Status status = Evaluate(asker, question, answers); !status.ok()) return status;
  const absl::StatusOr<ExitCode> end = Measure(asker, question, answers);
  if (!end.ok() || *end != ExitCode::kDone) return end;
  const absl::StatusOr<MeanFreeTimeFiles> files = MakeFiles(question, answers);
  if (!files.ok()) return files.status();
  if (absl::Status status = Write(*files, tools); !status.ok()) return status;
  const LargestZ largest = LargestDeviation(answers);
  tools.terminal.err << absl::StrFormat(
      "largest |z| = %.2f among %d estimates with an exact value\n", largest.value,
      largest.estimates);
  return tools.folder.Draw(kMeanFreeTimeFigure, tools.terminal);
}

}  // namespace

absl::StatusOr<MakeFigure> PlanMeanFreeTime(const FigureFlags& flags) {
  MeanFreeTimeQuestion question;
  Violations violations;
  const auto take = [&violations](auto parsed, auto& into) {
    if (parsed.ok()) into = *std::move(parsed);
    violations.Add(parsed.status());
  };
  if (flags.rho) take(ParseNumber("--rho", *flags.rho), question.rho);
  if (flags.delta) take(ParseNumberList("--delta", *flags.delta), question.delta);
  if (flags.samples) take(ParseCount("--samples", *flags.samples), question.samples);
  if (flags.seed) take(ParseSeed("--seed", *flags.seed), question.seed);
  violations.Add(RefuseFlag("--relaxation-delta", flags.relaxation_delta, kMeanFreeTimeFigure));
  violations.Add(RefuseFlag("--epsilon", flags.epsilon, kMeanFreeTimeFigure));
  violations.Add(RefuseFlag("--seconds", flags.seconds, kMeanFreeTimeFigure));
  if (absl::Status bad = violations.Lines(); !bad.ok()) return bad;
  return [question](const FigureTools& tools) {
    return WithServer(tools.server, [&](const Connection& connection) {
      return Make(question, tools, connection);
    });
  };
}

}  // namespace ballpiston::client
