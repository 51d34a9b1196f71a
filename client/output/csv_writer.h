// Results as CSV: a header, then one row for each estimate, each bin of the histograms, or each
// point of the curves. result_writer.h lists the columns.
#pragma once

#include <memory>
#include <ostream>

#include "client/output/result_writer.h"

namespace ballpiston::client {

// `out` must outlive the writer. With `has_comment` the first lines begin with # and hold the job,
// the versions of engine and client, and the specification.
std::unique_ptr<ResultWriter> NewCsvWriter(Format format, std::ostream& out,
                                           bool has_comment = false);

}  // namespace ballpiston::client
