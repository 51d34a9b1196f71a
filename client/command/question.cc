#include "client/command/question.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "client/command/points_file.h"
#include "client/command/verb_table.h"
#include "client/output/json.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

struct TextFile {
  std::string name;  // for messages: the path, or standard input
  std::string text;
};

// Throws no exception if a read fails; stream iterators could.
std::string ReadAll(std::istream& in) {
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// The file that a flag names; `-` is standard input.
absl::StatusOr<TextFile> ReadTextFile(const std::string& flag, const std::string& path) {
  if (path == "-") return TextFile{"standard input", ReadAll(std::cin)};
  std::ifstream in(path);
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  if (in && !is_folder) return TextFile{path, ReadAll(in)};
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " ", path, ": ", is_folder ? "is a folder" : std::strerror(errno)));
}

// `whole`, --spec or --again, replaces all other flags of the question. Checks only the flags on
// the command line: those of the config file are ignored.
absl::Status CheckAlone(const std::string& whole, const Options& options) {
  bool is_alone = options.spec.experiment() == v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED;
  for (const FlagGroup* group : QuestionFlags()) {
    for (const Flag& flag : group->flags) {
      is_alone = is_alone && (flag.name == whole || !options.given.contains(flag.name));
    }
  }
  if (is_alone) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(whole,
                   " holds the whole specification: give no EXPERIMENT, grid, target, --seed, "
                   "--model, --estimate, --verify, --precision or ",
                   whole == "--spec" ? "--again" : "--spec", " with it"));
}

}  // namespace

absl::StatusOr<v1::EnsembleSpec> SpecOf(const Options& options) {
  if (!options.again.empty()) {
    if (absl::Status bad = CheckAlone("--again", options); !bad.ok()) return bad;
    return v1::EnsembleSpec();
  }
  if (!options.spec_file.empty()) {
    if (absl::Status bad = CheckAlone("--spec", options); !bad.ok()) return bad;
    const absl::StatusOr<TextFile> file = ReadTextFile("--spec", options.spec_file);
    return file.ok() ? ParseSpec(file->name, file->text) : file.status();
  }
  if (options.spec.experiment() == v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED) {
    const auto name = [](std::string* out, const auto& choice) { out->append(choice.first); };
    return absl::InvalidArgumentError(
        absl::StrCat("name an EXPERIMENT (",
                     absl::StrJoin(EnumChoices<v1::EnsembleSpec::Experiment>(), ", ", name),
                     "), or give --spec FILE or --again JOB"));
  }
  v1::EnsembleSpec spec = options.spec;
  if (options.points_file.empty()) return spec;
  const absl::StatusOr<TextFile> file = ReadTextFile("--points", options.points_file);
  if (!file.ok()) return file.status();
  absl::Status bad = ParsePoints(file->name, file->text, *spec.mutable_grid());
  if (!bad.ok()) return bad;
  return spec;
}

absl::StatusOr<v1::EnsembleSpec> ParseSpec(absl::string_view name, absl::string_view json) {
  v1::EnsembleSpec spec;
  absl::ConsumePrefix(&json, "\xEF\xBB\xBF");  // the byte order mark that some programs write
  const absl::Status bad = ReadJson(std::string(json), spec);
  if (bad.ok()) return spec;
  return absl::InvalidArgumentError(absl::StrCat("--spec ", name, ": ", bad.message()));
}

VerbResult WithQuestion(const Options& options, const Terminal& terminal,
                        const VerbOfQuestion& verb) {
  const absl::StatusOr<v1::EnsembleSpec> spec = SpecOf(options);
  if (!spec.ok()) return spec.status();
  Options asked = options;
  asked.spec = *spec;
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    if (options.again.empty()) return verb(connection, asked);
    const auto job = connection.client.Get(options.again);
    if (!job.ok()) return job.status();
    asked.spec = job->spec();
    if (!options.given.contains("--label")) {
      asked.labels = {job->labels().begin(), job->labels().end()};
    }
    return verb(connection, asked);
  });
}

}  // namespace ballpiston::client
