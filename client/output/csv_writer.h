// Results as CSV: a header, then one row for each estimate, each bin of the histograms, or each
// point of the curves. result_writer.h lists the columns.
#pragma once

#include <memory>
#include <ostream>

#include "client/output/result_writer.h"

namespace ballpiston::client {

// `out` must outlive the writers.
std::unique_ptr<ResultWriter> NewEstimateCsvWriter(std::ostream& out);
std::unique_ptr<ResultWriter> NewHistogramCsvWriter(std::ostream& out);
std::unique_ptr<ResultWriter> NewCurveCsvWriter(std::ostream& out);

}  // namespace ballpiston::client
