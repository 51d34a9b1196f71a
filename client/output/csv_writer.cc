#include "client/output/csv_writer.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_join.h"
#include "client/output/csv_row.h"
#include "client/output/estimate_fields.h"
#include "client/output/number_text.h"
#include "client/output/parameter_text.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

using Cells = std::vector<std::string>;

std::string Optional(const std::optional<double>& x) { return x ? ExactText(*x) : ""; }

// Every row begins with the parameters, the model and the number of samples of its point.
class CsvWriter : public ResultWriter {
 public:
  explicit CsvWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob& job) override {
    parameters_ = ParameterColumns(job.spec().grid());
    Cells titles = parameters_.Titles();
    const Cells more = Titles();
    titles.insert(titles.end(), {"model", "samples"});
    titles.insert(titles.end(), more.begin(), more.end());
    out_ << CsvRow(titles);
  }

  void Add(const v1::PointResult& point) override {
    Cells first = parameters_.Cells(point.parameters());
    first.insert(first.end(), {Spelling(point.model()), ExactText(point.samples())});
    for (const Cells& row : Rows(point)) {
      Cells cells = first;
      cells.insert(cells.end(), row.begin(), row.end());
      out_ << CsvRow(cells);
    }
  }

  void End() override {}

 private:
  virtual Cells Titles() const = 0;
  virtual std::vector<Cells> Rows(const v1::PointResult& point) const = 0;

  std::ostream& out_;
  ParameterColumns parameters_{v1::Grid()};
};

class EstimateCsvWriter : public CsvWriter {
 public:
  using CsvWriter::CsvWriter;

 private:
  Cells Titles() const override {
    return {"name",    "value",       "standard_error", "exact",
            "z_score", "model_error", "noise_floor",    "limit"};
  }

  std::vector<Cells> Rows(const v1::PointResult& point) const override {
    std::vector<Cells> rows;
    for (const v1::Estimate& estimate : point.estimates()) {
      Cells row = {estimate.name(), ExactText(estimate.value())};
      for (const Field& field : {kError, kExact, kZScore, kModelError, kNoiseFloor, kLimit}) {
        row.push_back(Optional(field.Of(estimate)));
      }
      rows.push_back(std::move(row));
    }
    return rows;
  }
};

class HistogramCsvWriter : public CsvWriter {
 public:
  using CsvWriter::CsvWriter;

 private:
  Cells Titles() const override {
    return {"name", "sigma", "time", "lower", "upper", "count", "density", "exact_density"};
  }

  // A density integrates to 1 over the histograms of a name and a time.
  using Key = std::pair<std::string, double>;
  static Key KeyOf(const v1::Histogram& histogram) { return {histogram.name(), histogram.time()}; }

  std::vector<Cells> Rows(const v1::PointResult& point) const override {
    std::map<Key, double> totals;
    for (const v1::Histogram& histogram : point.histograms()) {
      totals[KeyOf(histogram)] +=
          std::accumulate(histogram.counts().begin(), histogram.counts().end(), 0.0);
    }
    std::vector<Cells> rows;
    for (const v1::Histogram& histogram : point.histograms()) {
      AddBins(histogram, totals[KeyOf(histogram)], rows);
    }
    return rows;
  }

  static void AddBins(const v1::Histogram& histogram, double total, std::vector<Cells>& rows) {
    const int bins = std::max(histogram.counts_size(), histogram.expected_probabilities_size());
    const double width = (histogram.upper() - histogram.lower()) / bins;
    for (int i = 0; i < bins; ++i) {
      std::optional<double> count, density, exact;
      if (i < histogram.counts_size()) count = histogram.counts(i);
      if (count && total > 0) density = *count / total / width;
      if (i < histogram.expected_probabilities_size()) {
        exact = histogram.expected_probabilities(i) / width;
      }
      rows.push_back({histogram.name(), ExactText(histogram.sigma()),
                      histogram.has_time() ? ExactText(histogram.time()) : "",
                      ExactText(histogram.lower() + i * width),
                      ExactText(histogram.lower() + (i + 1) * width), Optional(count),
                      Optional(density), Optional(exact)});
    }
  }
};

class CurveCsvWriter : public CsvWriter {
 public:
  using CsvWriter::CsvWriter;

 private:
  Cells Titles() const override {
    return {"name", "time", "position", "value", "standard_error", "limit"};
  }

  std::vector<Cells> Rows(const v1::PointResult& point) const override {
    std::vector<Cells> rows;
    for (const v1::Curve& curve : point.curves()) {
      for (const v1::Curve::Point& p : curve.points()) {
        rows.push_back({curve.name(), p.has_time() ? ExactText(p.time()) : "",
                        p.has_position() ? ExactText(p.position()) : "", ExactText(p.value()),
                        p.has_standard_error() ? ExactText(p.standard_error()) : "",
                        p.has_limit() ? ExactText(p.limit()) : ""});
      }
    }
    return rows;
  }
};

}  // namespace

std::unique_ptr<ResultWriter> NewEstimateCsvWriter(std::ostream& out) {
  return std::make_unique<EstimateCsvWriter>(out);
}

std::unique_ptr<ResultWriter> NewHistogramCsvWriter(std::ostream& out) {
  return std::make_unique<HistogramCsvWriter>(out);
}

std::unique_ptr<ResultWriter> NewCurveCsvWriter(std::ostream& out) {
  return std::make_unique<CurveCsvWriter>(out);
}

}  // namespace ballpiston::client
