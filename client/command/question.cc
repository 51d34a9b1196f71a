#include "client/command/question.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/command/number_list.h"
#include "client/command/suggestion.h"
#include "client/command/verb_table.h"
#include "client/output/json.h"
#include "client/output/spelling.h"
#include "client/output/table.h"

namespace ballpiston::client {
namespace {

using google::protobuf::FieldDescriptor;

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

// ---- a table of points ----

using Columns = std::vector<const FieldDescriptor*>;
using Texts = std::vector<absl::string_view>;

Texts CellsOf(absl::string_view line) {
  Texts cells = absl::StrSplit(line, ',');
  for (absl::string_view& cell : cells) {
    cell = absl::StripAsciiWhitespace(cell);
    if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') {
      cell = cell.substr(1, cell.size() - 2);
    }
  }
  return cells;
}

template <typename... Parts>
absl::Status Wrong(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

// A column names a list of the grid, but not that of the columns themselves.
absl::Status ReadHeader(const std::string& line, const Texts& names, v1::Grid& grid,
                        Columns& columns) {
  std::vector<std::string> parameters = FieldNames(*v1::Grid::descriptor());
  std::erase(parameters, "table");
  for (const absl::string_view name : names) {
    const auto found = std::find(parameters.begin(), parameters.end(), name);
    if (found == parameters.end()) {
      return Wrong(line, ": the column ", NotOneOf(name, parameters));
    }
    const FieldDescriptor* field = v1::Grid::descriptor()->FindFieldByName(*found);
    if (std::find(columns.begin(), columns.end(), field) != columns.end()) {
      return Wrong(line, ": the column ", name, " is there twice");
    }
    if (grid.GetReflection()->FieldSize(grid, field) > 0) {
      return Wrong("has the column ", name, ", and --", name, " is given; permitted: one of them");
    }
    columns.push_back(field);
    grid.add_table(*found);
  }
  return absl::OkStatus();
}

absl::Status AddCell(const FieldDescriptor& column, absl::string_view text, v1::Grid& grid) {
  const google::protobuf::Reflection& reflection = *grid.GetReflection();
  if (column.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    reflection.AddString(&grid, &column, ShapeText(text));
    return absl::OkStatus();
  }
  const absl::StatusOr<double> number = ParseNumber(text);
  if (number.ok()) reflection.AddDouble(&grid, &column, *number);
  return number.status();
}

absl::Status ReadRow(const std::string& line, const Texts& cells, const Columns& columns,
                     v1::Grid& grid) {
  if (cells.size() != columns.size()) {
    return Wrong(line, " has ", Counted(static_cast<double>(cells.size()), "value"),
                 "; the header names ", Counted(static_cast<double>(columns.size()), "column"));
  }
  for (size_t i = 0; i < cells.size(); ++i) {
    const absl::Status added = AddCell(*columns[i], cells[i], grid);
    if (added.ok()) continue;
    return Wrong(line, ", column ", columns[i]->name(), ": ", added.message());
  }
  return absl::OkStatus();
}

absl::Status ReadTable(absl::string_view csv, v1::Grid& grid) {
  absl::ConsumePrefix(&csv, "\xEF\xBB\xBF");  // a mark that some programs write first
  Columns columns;
  int64_t rows = 0, number = 0;
  for (const absl::string_view text : absl::StrSplit(csv, '\n')) {
    const std::string line = absl::StrCat("line ", ++number);
    if (absl::StripAsciiWhitespace(text).empty()) continue;
    const absl::Status read = columns.empty() ? ReadHeader(line, CellsOf(text), grid, columns)
                                              : ReadRow(line, CellsOf(text), columns, grid);
    if (!read.ok()) return read;
    if (rows++ > kMaxListLength) {
      return Wrong("has too many rows; permitted: 1 to ", kMaxListLength);
    }
  }
  if (rows == 0) return Wrong("is empty; its first line names the parameters");
  return rows == 1 ? Wrong("has no row below its header") : absl::OkStatus();
}

}  // namespace

absl::Status ParsePoints(const std::string& name, absl::string_view csv, v1::Grid& grid) {
  const absl::Status read = ReadTable(csv, grid);
  if (read.ok()) return read;
  return absl::InvalidArgumentError(absl::StrCat("--points ", name, ": ", read.message()));
}

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
