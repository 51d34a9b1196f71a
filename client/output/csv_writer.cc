#include "client/output/csv_writer.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/output/csv_row.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/parameter_text.h"

namespace ballpiston::client {
namespace {

// The columns of a CSV file that follow the parameters, the model and the number of samples, and
// the rows that a point has in them.
struct Rows {
  Cells titles;
  std::vector<Cells> (*of)(const v1::PointResult& point);
};

const Cells kEstimateFields = {"name",    "value",       "standard_error", "exact",
                               "z_score", "model_error", "noise_floor",    "limit"};

std::vector<Cells> Estimates(const v1::PointResult& point) {
  std::vector<Cells> rows;
  for (const auto& estimate : point.estimates()) {
    rows.push_back(FieldTexts(estimate, kEstimateFields));
  }
  return rows;
}

const Cells kCurveFields = {"time", "position", "value", "standard_error", "limit"};

std::vector<Cells> CurvePoints(const v1::PointResult& point) {
  std::vector<Cells> rows;
  for (const v1::Curve& curve : point.curves()) {
    for (const v1::Curve::Point& p : curve.points()) {
      rows.push_back(Joined({curve.name()}, FieldTexts(p, kCurveFields)));
    }
  }
  return rows;
}

std::string Optional(const std::optional<double>& x) { return x ? ExactText(*x) : ""; }

void AddBins(const v1::Histogram& histogram, double total, std::vector<Cells>& rows) {
  const int bins = std::max(histogram.counts_size(), histogram.expected_probabilities_size());
  const double width = (histogram.upper() - histogram.lower()) / bins;
  for (int i = 0; i < bins; ++i) {
    std::optional<double> count, density, exact;
    if (i < histogram.counts_size()) count = histogram.counts(i);
    if (count && total > 0) density = *count / total / width;
    if (i < histogram.expected_probabilities_size()) {
      exact = histogram.expected_probabilities(i) / width;
    }
    rows.push_back(Joined(
        FieldTexts(histogram, {"name", "sigma", "time"}),
        {ExactText(histogram.lower() + i * width), ExactText(histogram.lower() + (i + 1) * width),
         Optional(count), Optional(density), Optional(exact)}));
  }
}

// A density integrates to 1 over the histograms of a name and a time.
std::vector<Cells> Bins(const v1::PointResult& point) {
  std::map<std::pair<std::string, double>, double> totals;
  for (const v1::Histogram& histogram : point.histograms()) {
    totals[{histogram.name(), histogram.time()}] +=
        std::accumulate(histogram.counts().begin(), histogram.counts().end(), 0.0);
  }
  std::vector<Cells> rows;
  for (const v1::Histogram& histogram : point.histograms()) {
    AddBins(histogram, totals[{histogram.name(), histogram.time()}], rows);
  }
  return rows;
}

Rows RowsOf(Format format) {
  if (format == Format::kCsvCurves) return {Joined({"name"}, kCurveFields), &CurvePoints};
  if (format == Format::kCsv) return {kEstimateFields, &Estimates};
  return {{"name", "sigma", "time", "lower", "upper", "count", "density", "exact_density"}, &Bins};
}

class CsvWriter : public ResultWriter {
 public:
  CsvWriter(Rows rows, std::ostream& out, bool has_comment)
      : rows_(std::move(rows)), out_(out), has_comment_(has_comment) {}

  void Begin(const v1::EnsembleJob& job) override {
    if (has_comment_) {
      out_ << "# " << job.name() << ", engine " << job.engine_version() << ", client "
           << BALLPISTON_VERSION << "\n# " << Json(job.spec()) << '\n';
    }
    parameters_ = ParametersInCsv(job.spec().grid());
    out_ << CsvRow(Joined(Joined(parameters_, kPointFields), rows_.titles));
  }

  void Add(const v1::PointResult& point) override {
    const Cells first =
        Joined(FieldTexts(point.parameters(), parameters_), FieldTexts(point, kPointFields));
    for (const Cells& row : rows_.of(point)) out_ << CsvRow(Joined(first, row));
  }

  void End() override {}

 private:
  inline static const Cells kPointFields = {"model", "samples"};

  const Rows rows_;
  std::ostream& out_;
  const bool has_comment_;
  Cells parameters_;
};

}  // namespace

std::unique_ptr<ResultWriter> NewCsvWriter(Format format, std::ostream& out, bool has_comment) {
  return std::make_unique<CsvWriter>(RowsOf(format), out, has_comment);
}

}  // namespace ballpiston::client
