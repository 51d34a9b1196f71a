// The formats results are printed in.
#ifndef BALLPISTON_CLIENT_OUTPUT_FORMAT_H_
#define BALLPISTON_CLIENT_OUTPUT_FORMAT_H_

namespace ballpiston::client {

enum class Format {
  kTable,          // for people: aligned, as many digits as the error supports
  kJson,           // proto JSON with the proto's own field names, one document
  kJsonl,          // one JSON object a line, one line a point
  kCsv,            // a header, then one row for each point and estimate
  kCsvHistograms,  // one row for each bin
  kCsvCurves       // one row for each point of a curve
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_FORMAT_H_
