#include "client/output/npz_writer.h"

#include <zip.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/output/estimate_rows.h"
#include "client/output/json.h"
#include "client/output/npy_array.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// The part of an array that belongs to one point: a number, a row, or a row for each time.
struct Entry {
  std::vector<std::vector<double>> rows = {};
  size_t axes = 0;  // of the entry
};

// An array over the points, which grows by one entry for each.
class PointArray {
 public:
  void Set(size_t point, Entry entry) { entries_[point] = std::move(entry); }

  bool HasNumbers() const {
    for (const auto& [point, entry] : entries_) {
      for (const auto& row : entry.rows) {
        if (!std::all_of(row.begin(), row.end(), [](double x) { return std::isnan(x); }))
          return true;
      }
    }
    return false;
  }

  std::string Bytes(size_t points) const {
    size_t axes = 0, rows = 1, length = 1;
    for (const auto& [point, entry] : entries_) {
      axes = std::max(axes, entry.axes);
      rows = std::max(rows, entry.rows.size());
      for (const auto& row : entry.rows) length = std::max(length, row.size());
    }
    std::vector<double> elements(points * rows * length, kMissing);
    for (const auto& [point, entry] : entries_) {
      for (size_t i = 0; i < entry.rows.size(); ++i) {
        std::copy(entry.rows[i].begin(), entry.rows[i].end(),
                  elements.begin() + static_cast<ptrdiff_t>((point * rows + i) * length));
      }
    }
    std::vector<size_t> shape = {points};
    if (axes == 2) shape.push_back(rows);
    if (axes >= 1) shape.push_back(length);
    return NpyBytes(elements, shape);
  }

 private:
  std::map<size_t, Entry> entries_;
};

// Writes an archive with zip_add; a failure leaves `bytes` empty.
class Archive {
 public:
  Archive() : source_(zip_source_buffer_create(nullptr, 0, 0, nullptr)) {
    zip_source_keep(source_);
    archive_ = zip_open_from_source(source_, ZIP_TRUNCATE, nullptr);
  }
  ~Archive() {
    if (archive_ != nullptr) zip_discard(archive_);
    zip_source_free(source_);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  // The bytes have to live until Bytes().
  void Add(const std::string& name, const std::string& bytes) {
    zip_source_t* file = zip_source_buffer(archive_, bytes.data(), bytes.size(), 0);
    const zip_int64_t index = zip_file_add(archive_, (name + ".npy").c_str(), file, 0);
    if (index < 0) zip_source_free(file);
    // The same result gives the same bytes at any time.
    failed_ |=
        index < 0 || zip_file_set_mtime(archive_, static_cast<zip_uint64_t>(index), 0, 0) != 0;
  }

  std::string Bytes() {
    if (failed_ || zip_close(archive_) != 0) return "";
    archive_ = nullptr;
    std::string bytes;
    zip_stat_t stat;
    if (zip_source_stat(source_, &stat) != 0 || zip_source_open(source_) != 0) return "";
    bytes.resize(stat.size);
    const zip_int64_t read = zip_source_read(source_, bytes.data(), stat.size);
    zip_source_close(source_);
    return read == static_cast<zip_int64_t>(stat.size) ? bytes : "";
  }

 private:
  zip_source_t* source_;
  zip_t* archive_ = nullptr;
  bool failed_ = false;
};

class NpzWriter : public ResultWriter {
 public:
  explicit NpzWriter(std::ostream& out) : out_(out) {}

  void Begin(const v1::EnsembleJob& job) override {
    provenance_ = absl::StrCat("{\"job\": \"", job.name(), "\", \"engine_version\": \"",
                               job.engine_version(), "\", \"client_version\": \"",
                               BALLPISTON_VERSION, "\", \"spec\": ", Json(job.spec()), "}");
  }

  void Add(const v1::PointResult& point) override {
    AddParameters(point);
    AddEstimates(point);
    AddDivergence(point);
    AddHistograms(point);
    AddCurves(point);
    ++points_;
  }

  void End() override {
    std::map<std::string, std::string> files;
    for (const auto& [name, array] : numbers_) {
      if (array.HasNumbers()) files[name] = array.Bytes(points_);
    }
    for (auto& [name, texts] : texts_) {
      texts.resize(points_);
      files[name] = NpyBytes(texts, {points_});
    }
    files["index"] = NpyBytes(indices_, {points_});
    files["provenance"] = NpyBytes(std::vector<std::string>{provenance_}, {});
    Archive archive;
    for (const auto& [name, bytes] : files) archive.Add(name, bytes);
    const std::string bytes = archive.Bytes();
    if (bytes.empty()) out_.setstate(std::ios::badbit);
    out_ << bytes;
  }

 private:
  void Set(const std::string& name, double number) {
    numbers_[name].Set(points_, {.rows = {{number}}, .axes = 0});
  }
  void Set(const std::string& name, const std::string& text) {
    texts_[name].resize(points_ + 1);
    texts_[name].back() = text;
  }
  void Set(const std::string& name, std::vector<double> row) {
    numbers_[name].Set(points_, {.rows = {std::move(row)}, .axes = 1});
  }

  void AddParameters(const v1::PointResult& point) {
    const v1::PointParameters& p = point.parameters();
    indices_.push_back(point.index());
    Set("rho", p.rho());
    Set("delta", p.delta());
    if (p.has_epsilon()) Set("epsilon", p.epsilon());
    if (p.has_exponent()) Set("exponent", p.exponent());
    if (p.has_cells()) Set("cells", p.cells());
    if (p.has_temperature()) Set("temperature", p.temperature());
    if (p.has_hot()) Set("hot", p.hot());
    if (p.has_cold()) Set("cold", p.cold());
    Set("model", Spelling(point.model()));
    Set("samples", point.samples());
    Set("health_escapes", point.health().escapes());
    Set("health_max_energy_error", point.health().max_energy_error());
  }

  void AddEstimates(const v1::PointResult& point) {
    struct Suffix {
      const char* text;
      const Field& field;
    };
    const Suffix suffixes[] = {{"_standard_error", kError},   {"_exact", kExact},
                               {"_z_score", kZScore},         {"_model_error", kModelError},
                               {"_noise_floor", kNoiseFloor}, {"_limit", kLimit},
                               {"_batches", kBatches}};
    for (const v1::Estimate& estimate : point.estimates()) {
      Set(estimate.name(), estimate.value());
      for (const Suffix& suffix : suffixes) {
        if (const auto x = suffix.field.Of(estimate)) Set(estimate.name() + suffix.text, *x);
      }
    }
  }

  void AddDivergence(const v1::PointResult& point) {
    if (!point.has_kl_divergence()) return;
    const v1::KlDivergence& divergence = point.kl_divergence();
    Set("kl_divergence", divergence.value());
    Set("kl_divergence_noise_floor", divergence.noise_floor());
    Set("kl_divergence_cells", divergence.cells());
    Set("kl_divergence_noise_error", divergence.noise_error());
    Set("kl_divergence_standard_error", divergence.standard_error());
  }

  // Histograms of one name and sign: one, or one for each time.
  void AddHistograms(const v1::PointResult& point) {
    std::map<std::string, std::vector<const v1::Histogram*>> groups;
    for (const v1::Histogram& histogram : point.histograms()) {
      const char* sign = histogram.sigma() > 0 ? "_plus" : histogram.sigma() < 0 ? "_minus" : "";
      groups[absl::StrCat("histogram_", histogram.name(), sign)].push_back(&histogram);
    }
    for (const auto& [name, group] : groups) AddHistogramGroup(name, group);
  }

  void AddHistogramGroup(const std::string& name, const std::vector<const v1::Histogram*>& group) {
    const bool has_times = group.front()->has_time();
    Entry counts{.axes = has_times ? 2u : 1u}, expected = counts;
    std::vector<double> times;
    for (const v1::Histogram* histogram : group) {
      counts.rows.emplace_back(histogram->counts().begin(), histogram->counts().end());
      const auto& probabilities = histogram->expected_probabilities();
      expected.rows.emplace_back(probabilities.begin(), probabilities.end());
      times.push_back(histogram->time());
    }
    numbers_[name + "_counts"].Set(points_, std::move(counts));
    numbers_[name + "_expected"].Set(points_, std::move(expected));
    Set(name + "_lower", group.front()->lower());
    Set(name + "_upper", group.front()->upper());
    if (has_times) Set(name + "_time", std::move(times));
  }

  void AddCurves(const v1::PointResult& point) {
    for (const v1::Curve& curve : point.curves()) {
      const std::string name = "curve_" + curve.name();
      using Point = v1::Curve::Point;
      AddColumn(name + "_time", curve, &Point::has_time, &Point::time);
      AddColumn(name + "_position", curve, &Point::has_position, &Point::position);
      AddColumn(
          name + "_value", curve, [](const Point&) { return true; }, &Point::value);
      AddColumn(name + "_standard_error", curve, &Point::has_standard_error,
                &Point::standard_error);
      AddColumn(name + "_limit", curve, &Point::has_limit, &Point::limit);
    }
  }

  // Nothing if no point of the curve has the value.
  template <typename Has, typename Value>
  void AddColumn(const std::string& name, const v1::Curve& curve, Has has, Value value) {
    std::vector<double> column;
    bool any = false;
    for (const v1::Curve::Point& point : curve.points()) {
      const bool exists = std::invoke(has, point);
      column.push_back(exists ? std::invoke(value, point) : kMissing);
      any |= exists;
    }
    if (any) Set(name, std::move(column));
  }

  std::ostream& out_;
  std::string provenance_;
  size_t points_ = 0;
  std::vector<int64_t> indices_;
  std::map<std::string, PointArray> numbers_;
  std::map<std::string, std::vector<std::string>> texts_;
};

}  // namespace

std::unique_ptr<ResultWriter> NewNpzWriter(std::ostream& out) {
  return std::make_unique<NpzWriter>(out);
}

}  // namespace ballpiston::client
