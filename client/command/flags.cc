#include "client/command/flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

bool IsId(absl::string_view text) {
  constexpr size_t kLongest = 63;
  return !text.empty() && text.size() <= kLongest &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return absl::ascii_islower(static_cast<unsigned char>(c)) ||
                  absl::ascii_isdigit(static_cast<unsigned char>(c)) || c == '-';
         });
}

}  // namespace

void FormatFlag::AddTo(CLI::App& verb) {
  verb.add_option("--format", text, "table | json | jsonl | csv; table if not given");
}

void ProgressFlag::AddTo(CLI::App& verb) {
  verb.add_option("--progress", text,
                  "auto | bar | json | none, on standard error; auto: a bar on a terminal");
}

void JobArgument::AddTo(CLI::App& verb) {
  verb.add_option("JOB", text, "ensembleJobs/ID")->required();
}

absl::StatusOr<std::string> JobArgument::Name() const {
  constexpr absl::string_view kCollection = "ensembleJobs/";
  const absl::string_view id = absl::StripPrefix(text, kCollection);
  if (IsId(id)) return absl::StrCat(kCollection, id);
  return absl::InvalidArgumentError(
      absl::StrCat(Quoted(text),
                   " is not a job's name: write ensembleJobs/ID, or the ID alone; an ID is 1 to 63 "
                   "of a-z, 0-9 and hyphen"));
}

}  // namespace ballpiston::client
