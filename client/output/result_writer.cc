#include "client/output/result_writer.h"

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/model_reasons.h"
#include "client/output/spelling.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

// Writes one JSON document, or only its points, one on each line.
class JsonWriter : public ResultWriter {
 public:
  JsonWriter(std::ostream& out, bool is_document) : out_(out), is_document_(is_document) {}

  void Begin(const v1::EnsembleJob& job) override {
    if (!is_document_) return;
    out_ << "{\"client_version\": \"" << BALLPISTON_VERSION << "\",\n\"job\": " << Json(job)
         << ",\n\"points\": [";
  }
  void Add(const v1::PointResult& point) override {
    out_ << (is_document_ ? separator_ : "") << Json(point) << (is_document_ ? "" : "\n");
    separator_ = ",\n";
  }
  void End() override { out_ << (is_document_ ? "\n]}\n" : ""); }

 private:
  std::ostream& out_;
  const bool is_document_;
  const char* separator_ = "\n";
};

// A row for each estimate.
class CsvWriter : public ResultWriter {
 public:
  CsvWriter(std::ostream& out, bool is_file) : out_(out), is_file_(is_file) {}

  void Begin(const v1::EnsembleJob& job) override {
    if (is_file_) {
      out_ << "# " << job.name() << ", engine " << job.engine_version() << ", client "
           << BALLPISTON_VERSION << "\n# " << Json(job.spec()) << '\n';
    }
    parameters_ = ParametersInCsv(job.spec().grid());
    out_ << CsvRow(Joined({parameters_, kPointFields, kEstimateFields}));
  }
  void Add(const v1::PointResult& point) override {
    const Cells first =
        Joined({FieldTexts(point.parameters(), parameters_), FieldTexts(point, kPointFields)});
    for (const v1::Estimate& estimate : point.estimates()) {
      out_ << CsvRow(Joined({first, FieldTexts(estimate, kEstimateFields)}));
    }
  }
  void End() override {}

 private:
  inline static const Cells kPointFields = {"model", "samples"};
  inline static const Cells kEstimateFields = {"name",    "value",       "standard_error", "exact",
                                               "z_score", "model_error", "noise_floor",    "limit"};

  std::ostream& out_;
  const bool is_file_;
  Cells parameters_;
};

// Columns that a table has only if at least one estimate has the value.
const Cells kExtraColumns = {"model_error", "noise_floor", "limit"};

// An error is printed with two digits; another value ends at the estimate's decimal place.
std::string ExtraCell(const std::string& column, const v1::Estimate& row) {
  const std::optional<double> x = NumberIn(row, column);
  if (!x) return "";
  if (column == "model_error") return TwoDigits(*x);
  return Measured(row.value(), NumberIn(row, "standard_error"), x).exact;
}

// Keeps the points until the end, when the widths of the columns are known.
class TableWriter : public ResultWriter {
 public:
  explicit TableWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob& job) override { job_ = job; }
  void Add(const v1::PointResult& point) override { points_.push_back(point); }
  void End() override {
    for (const v1::PointResult& point : points_) models_.insert(Spelling(point.model()));
    out_ << Heading() << '\n';
    std::set<std::string> optional = OptionalParameters();
    optional.insert(kExtraColumns.begin(), kExtraColumns.end());
    optional.insert("model");
    TextTable table(Titles(), {"model", "estimate"}, optional);
    for (const v1::PointResult& point : points_) AddRows(point, table);
    if (!points_.empty()) table.Print(out_);
    PrintModelReasons(points_, out_);
  }

 private:
  std::string Heading() const {
    return absl::StrCat(
        Spelling(job_.spec().experiment()), ", ",
        models_.empty() ? "no finished points"
                        : absl::StrCat("model ", absl::StrJoin(models_, ", ")),
        job_.spec().precision() == v1::EnsembleSpec::SINGLE ? ", single precision" : "", ", seed ",
        job_.spec().seed(), ", engine ", job_.engine_version(), "  (", job_.name(), ", ",
        Spelling(job_.state()), ", ", job_.progress().points_done(), " of ",
        job_.progress().points(), " points)");
  }

  static Cells Titles() {
    return Joined({ParametersInTable(),
                   {"model", "samples", "estimate", "value", "error", "exact", "z"},
                   kExtraColumns});
  }

  Cells PointCells(const v1::PointResult& point) const {
    return Joined(
        {FieldTexts(point.parameters(), ParametersInTable(), &TenDigits),
         {models_.size() > 1 ? Spelling(point.model()) : "", ExactText(point.samples())}});
  }

  void AddRows(const v1::PointResult& point, TextTable& table) const {
    const Cells point_cells = PointCells(point);
    for (const v1::Estimate& row : point.estimates()) {
      const MeasuredText text =
          Measured(row.value(), NumberIn(row, "standard_error"), NumberIn(row, "exact"));
      const bool has_z = row.has_z_score() && !text.error.empty();
      const std::string z = has_z ? absl::StrFormat("%+.2f", row.z_score()) : "";
      Cells cells = Joined({point_cells, {row.name(), text.value, text.error, text.exact, z}});
      for (const std::string& column : kExtraColumns) cells.push_back(ExtraCell(column, row));
      table.AddRow(std::move(cells));
    }
    for (const std::string& remark : point.remarks()) table.AddLine("remark: " + remark);
  }

  std::ostream& out_;
  v1::EnsembleJob job_;
  std::vector<v1::PointResult> points_;
  std::set<std::string> models_;  // of all points; End fills it
};

}  // namespace

std::unique_ptr<ResultWriter> NewResultWriter(Format format, std::ostream& out, bool is_file) {
  if (format == Format::kTable) return std::make_unique<TableWriter>(out);
  if (format == Format::kCsv) return std::make_unique<CsvWriter>(out, is_file);
  return std::make_unique<JsonWriter>(out, /*is_document=*/format == Format::kJson);
}

}  // namespace ballpiston::client
