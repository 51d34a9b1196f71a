#include "client/output/result_file.h"

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/library/quoted.h"
#include "client/output/csv_writer.h"

namespace ballpiston::client {

absl::StatusOr<FileFormat> FormatOfFile(const std::string& path, Format asked) {
  const bool any = asked == Format::kTable;
  if (absl::EndsWith(path, ".json") && (any || asked == Format::kJson)) return FileFormat();
  if (absl::EndsWith(path, ".npz") && any) return FileFormat{.is_npz = true};
  if (absl::EndsWith(path, ".csv") && any) return FileFormat{Format::kCsv};
  if (absl::EndsWith(path, ".csv") && IsCsv(asked)) return FileFormat{asked};
  for (const char* ending : {".json", ".npz", ".csv"}) {
    if (!absl::EndsWith(path, ending)) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("--save: a file that ends in ", ending, " cannot have this --format"));
  }
  return absl::InvalidArgumentError(
      absl::StrCat("--save: ", Quoted(path), " does not end in .json, .csv or .npz"));
}

std::unique_ptr<ResultWriter> NewResultFileWriter(const FileFormat& format, std::ostream& out) {
  if (IsCsv(format.format)) return NewCsvWriter(format.format, out, /*has_comment=*/true);
  return NewResultWriter(format.format, out);
}

v1::ListResultsRequest::View ViewFor(const FileFormat& format) {
  return format.is_npz ? v1::ListResultsRequest::FULL : ViewFor(format.format);
}

}  // namespace ballpiston::client
