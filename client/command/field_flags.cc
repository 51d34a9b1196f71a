#include "client/command/field_flags.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/command/points_file.h"
#include "client/library/error_text.h"

namespace ballpiston::client {
namespace {

constexpr absl::string_view kSpec = "spec.";

// --outgoing-epsilon for outgoing_epsilon[2].
std::string FlagNamed(absl::string_view field) {
  const absl::string_view last = field.substr(field.rfind('.') + 1);
  return absl::StrCat("--", absl::StrReplaceAll(last.substr(0, last.find('[')), {{"_", "-"}}));
}

// "points.csv, line 4" for grid.delta[2], unless the command line has the flag of that list.
std::optional<std::string> LineOfPoint(absl::string_view field, const Options& options) {
  const bool has_flag = options.given.contains(FlagNamed(field));
  size_t row = 0;
  if (options.points_file.empty() || has_flag || !absl::ConsumePrefix(&field, "spec.grid.") ||
      !absl::ConsumeSuffix(&field, "]") ||
      !absl::SimpleAtoi(field.substr(field.find('[') + 1), &row)) {
    return std::nullopt;
  }
  const std::string& path = options.points_file;
  return absl::StrCat(path == "-" ? "standard input" : path, ", line ", LineOfRow(row));
}

std::string NameOf(const std::string& field, const Verb& verb, const Options& options) {
  if (field == "spec.experiment") return "EXPERIMENT";
  if (const auto line = LineOfPoint(field, options)) return *line;
  const std::string name = FlagNamed(field);
  const std::vector<const Flag*> flags = FlagsOf(verb);
  const bool is_flag = std::any_of(flags.begin(), flags.end(),
                                   [&name](const Flag* flag) { return LongName(*flag) == name; });
  return is_flag ? name : std::string(absl::StripPrefix(field, kSpec));
}

// The description of a field may name another one: permitted: target.samples.
std::string WithTargetFlags(const std::string& description) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const Flag& flag : TargetFlags().flags) {
    names.emplace_back("target." + KeyOf(flag), flag.name);
  }
  return absl::StrReplaceAll(description, names);
}

}  // namespace

std::string MessageWithFlags(const absl::Status& error, const Verb& verb, const Options& options) {
  const bool has_file = !options.spec_file.empty() || !options.again.empty();
  std::string message(error.message());
  for (const auto& [field, description] : ErrorViolations(error)) {
    const bool is_of_file = has_file && absl::StartsWith(field, kSpec);
    const std::string in_flags =
        is_of_file ? absl::StrCat(absl::StripPrefix(field, kSpec), ": ", description)
                   : absl::StrCat(NameOf(field, verb, options), ": ", WithTargetFlags(description));
    message = absl::StrReplaceAll(message, {{absl::StrCat(field, ": ", description), in_flags}});
  }
  return message;
}

}  // namespace ballpiston::client
