#include "client/output/result_writer.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/csv_writer.h"
#include "client/output/estimate_fields.h"
#include "client/output/json.h"
#include "client/output/model_reasons.h"
#include "client/output/number_text.h"
#include "client/output/parameter_text.h"
#include "client/output/spelling.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

std::string PointJson(v1::PointResult point) {
  point.clear_name();
  return Json(point);
}

class JsonlWriter : public ResultWriter {
 public:
  explicit JsonlWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob&) override {}
  void Add(const v1::PointResult& point) override { out_ << PointJson(point) << '\n'; }
  void End() override {}

 private:
  std::ostream& out_;
};

class JsonWriter : public ResultWriter {
 public:
  explicit JsonWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob& job) override {
    out_ << "{\"client_version\": \"" << BALLPISTON_VERSION << "\",\n\"job\": " << Json(job)
         << ",\n\"points\": [";
  }
  void Add(const v1::PointResult& point) override {
    out_ << (first_ ? "\n" : ",\n") << PointJson(point);
    first_ = false;
  }
  void End() override { out_ << "\n]}\n"; }

 private:
  std::ostream& out_;
  bool first_ = true;
};

// Columns that a table has only if at least one estimate has the value.
struct ExtraColumn {
  const char* title;
  Field field;
  // An error is printed with two digits; another value ends at the estimate's decimal place.
  bool is_error;
};
constexpr ExtraColumn kExtraColumns[] = {{"model_error", kModelError, true},
                                         {"noise_floor", kNoiseFloor, false},
                                         {"limit", kLimit, false}};

std::string ExtraCell(const ExtraColumn& column, const v1::Estimate& row) {
  const std::optional<double> x = column.field.Of(row);
  if (!x) return "";
  return column.is_error ? TwoDigits(*x) : Measured(row.value(), kError.Of(row), x).exact;
}

// Keeps the rows until the end, when the widths of the columns are known.
class TableWriter : public ResultWriter {
 public:
  explicit TableWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob& job) override { job_ = job; }

  void Add(const v1::PointResult& point) override {
    models_.insert(Spelling(point.model()));
    parameters_.Include(point.parameters());
    reasons_.Add(point.parameters(), point.model(), point.reason());
    points_.push_back({point.parameters(),
                       Spelling(point.model()),
                       ExactText(point.samples()),
                       {point.estimates().begin(), point.estimates().end()},
                       {point.remarks().begin(), point.remarks().end()}});
  }

  void End() override {
    FindExtraColumns();
    out_ << Heading() << '\n';
    TextTable table(Columns());
    for (const Point& point : points_) AddRows(point, table);
    if (!points_.empty()) table.Print(out_);
    reasons_.Print(out_);
  }

 private:
  struct Point {
    v1::PointParameters parameters;
    std::string model, samples;
    std::vector<v1::Estimate> rows;
    std::vector<std::string> remarks;
  };

  bool HasSeveralModels() const { return models_.size() > 1; }

  void FindExtraColumns() {
    for (const ExtraColumn& column : kExtraColumns) {
      const bool present = std::any_of(points_.begin(), points_.end(), [&](const Point& point) {
        return std::any_of(point.rows.begin(), point.rows.end(), [&](const v1::Estimate& row) {
          return column.field.Of(row).has_value();
        });
      });
      if (present) extra_columns_.push_back(column);
    }
  }

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
    std::vector<TextTable::Column> columns;
    for (const std::string& title : parameters_.Titles()) columns.push_back({title});
    if (HasSeveralModels()) columns.push_back({"model", TextTable::Column::kLeft});
    columns.push_back({"samples"});
    columns.push_back({"estimate", TextTable::Column::kLeft});
    for (const char* title : {"value", "error", "exact", "z"}) columns.push_back({title});
    for (const ExtraColumn& column : extra_columns_) columns.push_back({column.title});
    return columns;
  }

  std::vector<std::string> PointCells(const Point& point) const {
    std::vector<std::string> cells = parameters_.Cells(point.parameters);
    if (HasSeveralModels()) cells.push_back(point.model);
    cells.push_back(point.samples);
    return cells;
  }

  void AddRows(const Point& point, TextTable& table) const {
    const std::vector<std::string> point_cells = PointCells(point);
    for (const v1::Estimate& row : point.rows) {
      std::vector<std::string> cells = point_cells;
      const MeasuredText text = Measured(row.value(), kError.Of(row), kExact.Of(row));
      const std::string z = row.has_z_score() ? absl::StrFormat("%+.2f", row.z_score()) : "";
      cells.insert(cells.end(), {row.name(), text.value, text.error, text.exact, z});
      for (const ExtraColumn& column : extra_columns_) cells.push_back(ExtraCell(column, row));
      table.AddRow(std::move(cells));
    }
    for (const std::string& remark : point.remarks) table.AddLine("remark: " + remark);
  }

  std::ostream& out_;
  v1::EnsembleJob job_;
  std::vector<Point> points_;
  std::set<std::string> models_;
  ParametersShown parameters_;
  ModelReasons reasons_;
  std::vector<ExtraColumn> extra_columns_;
};

}  // namespace

std::unique_ptr<ResultWriter> NewResultWriter(Format format, std::ostream& out) {
  switch (format) {
    case Format::kJson:
      return std::make_unique<JsonWriter>(out);
    case Format::kJsonl:
      return std::make_unique<JsonlWriter>(out);
    case Format::kCsv:
      return NewEstimateCsvWriter(out);
    case Format::kCsvHistograms:
      return NewHistogramCsvWriter(out);
    case Format::kCsvCurves:
      return NewCurveCsvWriter(out);
    case Format::kTable:
      break;
  }
  return std::make_unique<TableWriter>(out);
}

v1::ListResultsRequest::View ViewFor(Format format) {
  const bool is_basic = format == Format::kTable || format == Format::kCsv;
  return is_basic ? v1::ListResultsRequest::BASIC : v1::ListResultsRequest::FULL;
}

}  // namespace ballpiston::client
