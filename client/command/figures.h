// The figures that the verb `figure` can make, one file each.
//
// A figure checks its flags before anything is done.
#ifndef BALLPISTON_CLIENT_COMMAND_FIGURES_H_
#define BALLPISTON_CLIENT_COMMAND_FIGURES_H_

#include <functional>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/command/connection.h"
#include "client/command/exit_code.h"
#include "client/command/figure_folder.h"
#include "client/command/interrupts.h"
#include "client/command/verbs.h"
#include "client/output/progress_reporter.h"

namespace ballpiston::client {

// As they were written; empty: not given. Not every figure has each of them.
struct FigureFlags {
  std::optional<std::string> rho, delta, relaxation_delta, epsilon, samples, seconds, seed;
};

// What a figure is made with.
struct FigureTools {
  const ServerFlag& server;
  const FigureFolder& folder;
  ProgressStyle style;
  Interrupts& interrupts;
  Terminal& terminal;
};

using MakeFigure = std::function<absl::StatusOr<ExitCode>(const FigureTools&)>;

// INVALID_ARGUMENT, a line for each flag that is wrong or not this figure's.
absl::StatusOr<MakeFigure> PlanMeanFreeTime(const FigureFlags& flags);
absl::StatusOr<MakeFigure> PlanSpeedAccuracy(const FigureFlags& flags);

// INVALID_ARGUMENT if the flag, which the figure has not, was given.
absl::Status RefuseFlag(const char* flag, const std::optional<std::string>& text,
                        const char* figure);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_FIGURES_H_
