// A result in a file of its own, which carries the job's name, its specification with the seed, and
// the versions of engine and client. The file's ending selects the format:
//
//   .json  file::v1::SavedResult: everything; ballpiston.load in Python reads it
//   .csv   estimates, or with --format csv-histograms or csv-curves these; the first lines begin
//          with # and hold the job and the specification
//   .npz   NumPy arrays, which the Python package makes of the first format (arrays.py)
#pragma once

#include <memory>
#include <ostream>
#include <string>

#include "absl/status/statusor.h"
#include "client/output/format.h"
#include "client/output/result_writer.h"

namespace ballpiston::client {

struct FileFormat {
  Format format = Format::kJson;  // as the writer below writes it
  bool is_npz = false;            // then the Python package converts it
};

// The format of the file. `asked`: the value of --format; Format::kTable if it was not given.
// INVALID_ARGUMENT names --save, the path and the permitted endings, or the format that does not go
// with the ending.
absl::StatusOr<FileFormat> FormatOfFile(const std::string& path, Format asked);

// `out` has to outlive the writer.
std::unique_ptr<ResultWriter> NewResultFileWriter(const FileFormat& format, std::ostream& out);

v1::ListResultsRequest::View ViewFor(const FileFormat& format);

}  // namespace ballpiston::client
