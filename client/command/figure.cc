// ballpiston figure NAME --out DIR: measures what a figure of the paper shows, writes data and a
// gnuplot script, and draws it. Prints the files' names.
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/connection.h"
#include "client/command/create_job.h"
#include "client/command/flags.h"
#include "client/command/follow_job.h"
#include "client/command/interrupts.h"
#include "client/command/number_list.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/figure/mean_free_time_figure.h"
#include "client/library/analytic_client.h"
#include "client/library/child_process.h"
#include "client/library/ensemble_client.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

absl::Status WriteFile(const fs::path& path, const std::string& content) {
  std::ofstream file(path);
  file << content;
  file.close();
  if (file) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("--out: cannot write ", path.string()));
}

absl::Status MakeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--out: cannot make the folder ", folder, ": ", error.message()));
}

// Asks the server; one job after the other, so that Ctrl-C speaks of one.
class Asker {
 public:
  Asker(const Connection& connection, ProgressStyle style, Interrupts& interrupts,
        std::ostream& err)
      : connection_(connection),
        style_(style),
        interrupts_(interrupts),
        err_(err),
        client_(connection.channel) {}

  // The points of a job that succeeded. `*end` tells how it ended otherwise.
  absl::StatusOr<std::vector<v1::PointResult>> Measure(const v1::EnsembleSpec& spec,
                                                       ExitCode& end) const {
    const absl::StatusOr<v1::EnsembleJob> job = CreateJob(connection_, spec);
    if (!job.ok()) return job.status();
    const auto ended = FollowJob(connection_, job->name(), style_, interrupts_, err_);
    if (!ended.ok()) return ended.status();
    end = ended->has_value() ? ReportEnd(**ended, err_) : ExitCode::kInterrupted;
    if (end != ExitCode::kDone) return std::vector<v1::PointResult>();
    return client_.Results(job->name(), v1::ListResultsRequest::BASIC);
  }

  absl::StatusOr<v1::EvaluatePairsResponse> Evaluate(
      const v1::EvaluatePairsRequest& request) const {
    const AnalyticClient client(connection_.channel);
    return connection_.Ask([&] { return client.EvaluatePairs(request); });
  }

 private:
  const Connection& connection_;
  const ProgressStyle style_;
  Interrupts& interrupts_;
  std::ostream& err_;
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

struct Figure {
  std::string name;
  std::string folder;
  std::optional<std::string> rho, delta, samples, seed;
  ServerFlag server;
  ProgressFlag progress;

  void AddTo(CLI::App& verb) {
    verb.add_option("NAME", name, kMeanFreeTimeFigure)->required();
    verb.add_option("--out", folder, "folder for data, script and picture")->required();
    verb.add_option("--rho", rho, "disc radius; the paper's if not given");
    verb.add_option("--delta", delta, "LIST of penetrations; 0.2,0.1,0.05 if not given");
    verb.add_option("--samples", samples, "at each point; 10000 if not given");
    verb.add_option("--seed", seed, "of the random numbers; 0 if not given");
    server.AddTo(verb);
    progress.AddTo(verb);
  }

  absl::Status CheckName() const {
    if (name == kMeanFreeTimeFigure) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat(
        "figure '", name, "' is not offered by this version; it offers ", kMeanFreeTimeFigure));
  }

  absl::StatusOr<MeanFreeTimeQuestion> Question() const {
    MeanFreeTimeQuestion question;
    Violations violations;
    const auto take = [&violations](auto parsed, auto& into) {
      if (parsed.ok()) into = *std::move(parsed);
      violations.Add(parsed.status());
    };
    if (rho) take(ParseNumber("--rho", *rho), question.rho);
    if (delta) take(ParseNumberList("--delta", *delta), question.delta);
    if (samples) take(ParseCount("--samples", *samples), question.samples);
    if (seed) take(ParseSeed("--seed", *seed), question.seed);
    if (absl::Status bad = violations.Lines(); !bad.ok()) return bad;
    return question;
  }

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<MeanFreeTimeQuestion> question = Question();
    const absl::StatusOr<ProgressStyle> style = ParseProgressStyle(progress.text);
    const Violations violations({CheckName(), question.status(), style.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    if (absl::Status made = MakeFolder(folder); !made.ok()) return made;
    Interrupts interrupts;  // before gRPC starts threads
    return WithServer(server, [&](const Connection& connection) {
      return Draw(Asker(connection, *style, interrupts, terminal.err), *question, terminal);
    });
  }

  absl::StatusOr<ExitCode> Draw(const Asker& asker, const MeanFreeTimeQuestion& question,
                                Terminal& terminal) const {
    MeanFreeTimeAnswers answers;
    if (absl::Status status = Evaluate(asker, question, answers); !status.ok()) return status;
    const absl::StatusOr<ExitCode> end = Measure(asker, question, answers);
    if (!end.ok() || *end != ExitCode::kDone) return end;
    const absl::StatusOr<MeanFreeTimeFiles> files = MakeFiles(question, answers);
    if (!files.ok()) return files.status();
    if (absl::Status status = Write(*files, terminal.out); !status.ok()) return status;
    const LargestZ largest = LargestDeviation(answers);
    terminal.err << absl::StrFormat("largest |z| = %.2f among %d estimates with an exact value\n",
                                    largest.value, largest.estimates);
    return RunGnuplot(terminal);
  }

  absl::Status Write(const MeanFreeTimeFiles& files, std::ostream& out) const {
    const std::pair<const char*, const std::string&> contents[] = {{".csv", files.measured_csv},
                                                                   {"-inset.csv", files.inset_csv},
                                                                   {"-exact.csv", files.exact_csv},
                                                                   {".gnuplot", files.script}};
    for (const auto& [suffix, content] : contents) {
      const fs::path path = fs::path(folder) / (name + suffix);
      if (absl::Status status = WriteFile(path, content); !status.ok()) return status;
      out << path.string() << '\n';
    }
    return absl::OkStatus();
  }

  // Without gnuplot the data and the script are the result.
  absl::StatusOr<ExitCode> RunGnuplot(Terminal& terminal) const {
    const std::string script = name + ".gnuplot";
    const absl::StatusOr<int> status = RunChild(
        {.command = {"gnuplot", script}, .folder = folder, .output = "", .detached = false});
    if (absl::IsNotFound(status.status())) {
      terminal.err << "ballpiston: gnuplot is not installed; to draw the figure where it is: cd "
                   << folder << " && gnuplot " << script << '\n';
      return ExitCode::kDone;
    }
    if (!status.ok()) return status.status();
    if (*status != 0) {
      return absl::InternalError(absl::StrCat("gnuplot ended with exit status ", *status));
    }
    terminal.out << (fs::path(folder) / (name + ".svg")).string() << '\n';
    return ExitCode::kDone;
  }
};

}  // namespace

void AddFigure(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("figure", "data, gnuplot script and SVG of a figure");
  const auto figure = std::make_shared<Figure>();
  figure->AddTo(*verb);
  verb->callback([&action, figure] { action = [figure](Terminal& t) { return figure->Act(t); }; });
}

}  // namespace ballpiston::client
