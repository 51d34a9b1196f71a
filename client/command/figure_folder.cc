#include "client/command/figure_folder.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "client/library/child_process.h"

namespace ballpiston::client {

namespace fs = std::filesystem;

absl::Status FigureFolder::Make() const {
  std::error_code error;
  fs::create_directories(path_, error);
  if (!error) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--out: cannot make the folder ", path_, ": ", error.message()));
}

absl::Status FigureFolder::Write(const std::string& name, const std::string& content,
                                 Terminal& terminal) const {
  const std::string path = (fs::path(path_) / name).string();
  std::ofstream file(path);
  file << content;
  file.close();
  if (!file) return absl::InvalidArgumentError(absl::StrCat("--out: cannot write ", path));
  terminal.out << path << '\n';
  return absl::OkStatus();
}

absl::StatusOr<ExitCode> FigureFolder::Draw(const std::string& name, Terminal& terminal) const {
  const std::string script = name + ".gnuplot";
  const absl::StatusOr<int> status =
      RunChild({.command = {"gnuplot", script}, .folder = path_, .output = "", .detached = false});
  if (absl::IsNotFound(status.status())) {
    terminal.err << "ballpiston: gnuplot is not installed; to draw the figure where it is: cd "
                 << path_ << " && gnuplot " << script << '\n';
    return ExitCode::kDone;
  }
  if (!status.ok()) return status.status();
  if (*status != 0) {
    return absl::InternalError(absl::StrCat("gnuplot ended with exit status ", *status));
  }
  terminal.out << (fs::path(path_) / (name + ".svg")).string() << '\n';
  return ExitCode::kDone;
}

}  // namespace ballpiston::client
