// The output formats.
#pragma once

namespace ballpiston::client {

enum class Format {
  kTable,          // aligned text, with as many digits as the standard error supports
  kJson,           // one document of proto JSON with the proto's field names
  kJsonl,          // one JSON object per line and point
  kCsv,            // a header, then one row for each point and estimate
  kCsvHistograms,  // one row for each bin
  kCsvCurves       // one row for each point of a curve
};

constexpr bool IsCsv(Format format) { return format >= Format::kCsv; }

}  // namespace ballpiston::client
