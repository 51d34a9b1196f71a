#include "client/output/result_writer.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/result_row.h"
#include "client/output/spelling.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

std::string ExactOrEmpty(std::optional<double> x) { return x ? ExactText(*x) : ""; }

std::optional<double> EpsilonOf(const v1::PointResult& point) {
  if (!point.parameters().has_epsilon()) return std::nullopt;
  return point.parameters().epsilon();
}

std::optional<double> ExponentOf(const v1::PointResult& point) {
  if (!point.parameters().has_exponent()) return std::nullopt;
  return point.parameters().exponent();
}

class CsvWriter : public ResultWriter {
 public:
  explicit CsvWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob&) override {
    out_ << "rho,delta,epsilon,exponent,model,samples,name,value,standard_error,exact,z_score\n";
  }
  void Add(const v1::PointResult& point) override {
    const std::string prefix =
        absl::StrJoin({ExactText(point.parameters().rho()), ExactText(point.parameters().delta()),
                       ExactOrEmpty(EpsilonOf(point)), ExactOrEmpty(ExponentOf(point)),
                       Spelling(point.model()), ExactText(point.samples())},
                      ",");
    for (const ResultRow& row : ResultRows(point)) {
      out_ << prefix << ',' << row.name << ',' << ExactText(row.value) << ','
           << ExactOrEmpty(row.standard_error) << ',' << ExactOrEmpty(row.exact) << ','
           << ExactOrEmpty(row.z_score) << '\n';
    }
  }
  void End() override {}

 private:
  std::ostream& out_;
};

class JsonlWriter : public ResultWriter {
 public:
  explicit JsonlWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob&) override {}
  void Add(const v1::PointResult& point) override { out_ << Json(point) << '\n'; }
  void End() override {}

 private:
  std::ostream& out_;
};

class JsonWriter : public ResultWriter {
 public:
  explicit JsonWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob& job) override {
    out_ << "{\"job\": " << Json(job) << ",\n\"points\": [";
  }
  void Add(const v1::PointResult& point) override {
    out_ << (first_ ? "\n" : ",\n") << Json(point);
    first_ = false;
  }
  void End() override { out_ << "\n]}\n"; }

 private:
  std::ostream& out_;
  bool first_ = true;
};

// Keeps the rows until the end, when the columns' widths are known.
class TableWriter : public ResultWriter {
 public:
  explicit TableWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob& job) override { job_ = job; }

  void Add(const v1::PointResult& point) override {
    models_.insert(Spelling(point.model()));
    has_epsilon_ = has_epsilon_ || point.parameters().has_epsilon();
    has_exponent_ = has_exponent_ || point.parameters().has_exponent();
    points_.push_back(point);
    points_.back().clear_histograms();
  }

  void End() override {
    out_ << Heading() << '\n';
    TextTable table(Columns());
    for (const v1::PointResult& point : points_) AddRows(point, table);
    if (!points_.empty()) table.Print(out_);
  }

 private:
  std::string Heading() const {
    return absl::StrCat(Spelling(job_.spec().experiment()), ", ",
                        models_.empty() ? "no finished points"
                                        : absl::StrCat("model ", absl::StrJoin(models_, ", ")),
                        ", seed ", job_.spec().seed(), ", engine ", job_.engine_version(), "  (",
                        job_.name(), ", ", Spelling(job_.state()), ", ",
                        job_.progress().points_done(), " of ", job_.progress().points(),
                        " points)");
  }

  std::vector<TextTable::Column> Columns() const {
    std::vector<TextTable::Column> columns = {{"rho"}, {"delta"}};
    if (has_epsilon_) columns.push_back({"epsilon"});
    if (has_exponent_) columns.push_back({"exponent"});
    columns.push_back({"samples"});
    columns.push_back({"estimate", TextTable::Column::kLeft});
    for (const char* title : {"value", "error", "exact", "z"}) columns.push_back({title});
    return columns;
  }

  std::vector<std::string> ParameterCells(const v1::PointResult& point) const {
    const auto cell = [](double x) { return absl::StrFormat("%.10g", x); };
    std::vector<std::string> cells = {cell(point.parameters().rho()),
                                      cell(point.parameters().delta())};
    const auto epsilon = EpsilonOf(point);
    const auto exponent = ExponentOf(point);
    if (has_epsilon_) cells.push_back(epsilon ? cell(*epsilon) : "");
    if (has_exponent_) cells.push_back(exponent ? cell(*exponent) : "");
    cells.push_back(ExactText(point.samples()));
    return cells;
  }

  void AddRows(const v1::PointResult& point, TextTable& table) const {
    for (const ResultRow& row : ResultRows(point)) {
      std::vector<std::string> cells = ParameterCells(point);
      const MeasuredText text = Measured(row.value, row.standard_error, row.exact);
      const std::string z = row.z_score ? absl::StrFormat("%+.2f", *row.z_score) : "";
      cells.insert(cells.end(), {row.name, text.value, text.error, text.exact, z});
      table.AddRow(std::move(cells));
    }
  }

  std::ostream& out_;
  v1::EnsembleJob job_;
  std::vector<v1::PointResult> points_;
  std::set<std::string> models_;
  bool has_epsilon_ = false;
  bool has_exponent_ = false;
};

}  // namespace

std::unique_ptr<ResultWriter> NewResultWriter(Format format, std::ostream& out) {
  switch (format) {
    case Format::kJson:
      return std::make_unique<JsonWriter>(out);
    case Format::kJsonl:
      return std::make_unique<JsonlWriter>(out);
    case Format::kCsv:
      return std::make_unique<CsvWriter>(out);
    case Format::kTable:
      break;
  }
  return std::make_unique<TableWriter>(out);
}

bool ShowsHistograms(Format format) { return format == Format::kJson || format == Format::kJsonl; }

}  // namespace ballpiston::client
