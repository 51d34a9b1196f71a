// The client's printing of results that a server sent, in every format.
#include <iterator>
#include <sstream>

#include "ballpiston/v1/ensemble.pb.h"
#include "client/output/result_writer.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

std::string Printed(const v1::ListResultsResponse& page, client::Format format) {
  std::ostringstream out;
  const auto writer = client::NewResultWriter(format, out);
  writer->Begin(v1::EnsembleJob());
  for (const v1::PointResult& point : page.results()) writer->Add(point);
  writer->End();
  return out.str();
}

void RequirePrinted(const v1::ListResultsResponse& page, client::Format format) {
  const std::string printed = Printed(page, format);
  const bool may_be_empty = format == client::Format::kJsonl && page.results().empty();
  Require(may_be_empty || printed.ends_with("\n"), "what is printed ends with its line");
}

void CheckPrintedResult(const std::string& bytes) {
  v1::ListResultsResponse page;
  if (!page.ParseFromString(bytes)) return;
  constexpr client::Format kFormats[] = {client::Format::kTable, client::Format::kCsv,
                                         client::Format::kCsvHistograms,
                                         client::Format::kCsvCurves};
  RequirePrinted(page, kFormats[bytes.size() % std::size(kFormats)]);
  if (!IsOneIn(128, bytes)) return;  // slow, and nearly all of it the library's
  RequirePrinted(page, bytes.size() % 2 == 0 ? client::Format::kJson : client::Format::kJsonl);
}

const Registration kPrintedResult({.name = "printed_result",
                                   .check = CheckPrintedResult,
                                   .message = &v1::ListResultsResponse::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz
