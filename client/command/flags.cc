#include "client/command/flags.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace ballpiston::client {

absl::StatusOr<std::string> JobArgument::Name() const {
  constexpr absl::string_view kCollection = "ensembleJobs/";
  const absl::string_view id = absl::StripPrefix(text, kCollection);
  if (id.empty() || id.find_first_of("/ \t\n") != absl::string_view::npos) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", text, "' is not a job's name: write ensembleJobs/ID, or the ID alone"));
  }
  return absl::StrCat(kCollection, id);
}

}  // namespace ballpiston::client
