// The client's --spec FILE: proto JSON.
#include "client/command/spec_file.h"

#include "absl/strings/match.h"
#include "client/output/json.h"
#include "server/convert/spec.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

void CheckSpecFile(const std::string& json) {
  const absl::StatusOr<v1::EnsembleSpec> spec = client::ParseSpec("FILE", json);
  if (!spec.ok()) {
    Require(absl::IsInvalidArgument(spec.status()), "what is wrong is the argument");
    return Require(absl::StartsWith(spec.status().message(), "--spec FILE: "), "the flag is named");
  }
  const std::string printed = client::Json(*spec);
  if (printed == "null") return;  // a budget beyond what JSON has
  const absl::StatusOr<v1::EnsembleSpec> again = client::ParseSpec("FILE", printed);
  Require(again.ok(), "what is printed can be read");
  Require(server::SpecBytes(*again) == server::SpecBytes(*spec), "what is read was printed");
}

const Registration kSpecFile({.name = "spec_file", .check = CheckSpecFile});

}  // namespace
}  // namespace ballpiston::fuzz
