// The folder that a figure's files go to.
#ifndef BALLPISTON_CLIENT_COMMAND_FIGURE_FOLDER_H_
#define BALLPISTON_CLIENT_COMMAND_FIGURE_FOLDER_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/command/exit_code.h"
#include "client/command/verbs.h"

namespace ballpiston::client {

class FigureFolder {
 public:
  explicit FigureFolder(std::string path) : path_(std::move(path)) {}

  absl::Status Make() const;  // with its parents; OK if it is there

  // Writes the file and prints its path on standard output.
  absl::Status Write(const std::string& name, const std::string& content, Terminal& terminal) const;

  // Runs NAME.gnuplot there, which writes NAME.svg. Without gnuplot, data and script are the
  // result, and standard error says how to draw them later.
  absl::StatusOr<ExitCode> Draw(const std::string& name, Terminal& terminal) const;

 private:
  const std::string path_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_FIGURE_FOLDER_H_
