// ballpiston figure NAME --out DIR: measures what a figure shows, writes data and a gnuplot script,
// and draws it. Prints the files' names.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/command/comparison_program.h"
#include "client/command/connection.h"
#include "client/command/figure_folder.h"
#include "client/command/figures.h"
#include "client/command/flags.h"
#include "client/command/interrupts.h"
#include "client/command/verbs.h"
#include "client/command/violations.h"
#include "client/figure/mean_free_time_figure.h"
#include "client/figure/speed_accuracy_figure.h"
#include "client/library/quoted.h"

namespace ballpiston::client {

absl::Status RefuseFlag(const char* flag, const std::optional<std::string>& text,
                        const char* figure) {
  if (!text) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(flag, ": ", Quoted(*text), ", but the figure ", figure, " has no such flag"));
}

namespace {

struct Figure {
  std::string name;
  std::string folder;
  FigureFlags flags;
  ServerFlag server;
  ProgressFlag progress;

  void AddTo(CLI::App& verb) {
    verb.add_option("NAME", name, absl::StrCat(kMeanFreeTimeFigure, " | ", kSpeedAccuracyFigure))
        ->required();
    verb.add_option("--out", folder, "folder for data, script and picture")->required();
    verb.add_option("--rho", flags.rho, "disc radius; the paper's if not given");
    verb.add_option("--delta", flags.delta,
                    "mean-free-time: LIST of penetrations, 0.2,0.1,0.05 if not given; "
                    "speed-accuracy: one, 0.1 if not given");
    verb.add_option("--relaxation-delta", flags.relaxation_delta,
                    "speed-accuracy: LIST of at most 8 penetrations at which relaxation times are "
                    "compared; if not given those of 0.2,0.1,0.05,0.025 that rho permits");
    verb.add_option("--epsilon", flags.epsilon,
                    "speed-accuracy: the piston's energy; 0.125 if not given");
    verb.add_option("--samples", flags.samples,
                    "mean-free-time: at each point; 10000 if not given");
    verb.add_option(
        "--seconds", flags.seconds,
        "speed-accuracy: work of each method's largest run, 0.01 to 60; 1 if not given");
    verb.add_option("--seed", flags.seed, "of the random numbers; 0 if not given");
    server.AddTo(verb);
    progress.AddTo(verb);
    verb.footer(absl::StrCat(
        "The figure speed-accuracy is measured on this machine, without a server, by the program ",
        kComparisonProgram, ", which has to lie in the folder of ballpiston."));
  }

  absl::StatusOr<MakeFigure> Plan() const {
    if (name == kMeanFreeTimeFigure) return PlanMeanFreeTime(flags);
    if (name == kSpeedAccuracyFigure) return PlanSpeedAccuracy(flags);
    return absl::InvalidArgumentError(
        absl::StrCat("figure ", Quoted(name), " is not offered by this version; it offers ",
                     kMeanFreeTimeFigure, ", ", kSpeedAccuracyFigure));
  }

  absl::StatusOr<ExitCode> Act(Terminal& terminal) const {
    const absl::StatusOr<MakeFigure> make = Plan();
    const absl::StatusOr<ProgressStyle> style = ParseProgressStyle(progress.text);
    const Violations violations({make.status(), style.status(), server.Check()});
    if (absl::Status bad = violations.Report(); !bad.ok()) return bad;
    const FigureFolder out(folder);
    if (absl::Status made = out.Make(); !made.ok()) return made;
    Interrupts interrupts;  // before gRPC starts threads
    return (*make)({server, out, *style, interrupts, terminal});
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
