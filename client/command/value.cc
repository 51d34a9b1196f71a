#include "client/command/value.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/command/number_list.h"

namespace ballpiston::client {
namespace {

using google::protobuf::Timestamp;
using google::protobuf::util::TimeUtil;

absl::StatusOr<std::map<std::string, std::string>> ParseLabels(absl::string_view text) {
  std::map<std::string, std::string> labels;
  for (const absl::string_view label : absl::StrSplit(text, ',')) {
    const size_t equals = label.find('=');
    if (equals == label.npos) return NotPermitted(label, "is not a label: write KEY=VALUE");
    const bool is_new = labels.emplace(label.substr(0, equals), label.substr(equals + 1)).second;
    if (!is_new) return NotPermitted(label, "has a key that is given twice");
  }
  return labels;
}

// TimeUtil also reads fewer digits.
bool HasAllDigits(const std::string& time) {
  return time.size() >= 20 && time[4] == '-' && time[7] == '-' && time[10] == 'T' &&
         time[13] == ':' && time[16] == ':';
}

}  // namespace

absl::StatusOr<bool> ParseBool(absl::string_view text) {
  bool value = false;
  if (absl::SimpleAtob(text, &value)) return value;
  return NotPermitted(text, "is neither true nor false");
}

absl::StatusOr<std::string> ParseText(absl::string_view text) {
  if (!text.empty()) return std::string(text);
  return absl::InvalidArgumentError("is empty");
}

absl::StatusOr<std::string> ParseJobName(absl::string_view text) {
  constexpr absl::string_view kCollection = "ensembleJobs/";
  constexpr size_t kLongest = 63;
  const absl::string_view id = absl::StripPrefix(text, kCollection);
  const bool is_id = std::all_of(id.begin(), id.end(), [](unsigned char c) {
    return absl::ascii_islower(c) || absl::ascii_isdigit(c) || c == '-';
  });
  if (is_id && !id.empty() && id.size() <= kLongest) return absl::StrCat(kCollection, id);
  return NotPermitted(
      text,
      "is not a job's name: write ensembleJobs/ID, or the ID alone; an ID is 1 to 63 of "
      "a-z, 0-9 and hyphen");
}

absl::StatusOr<Timestamp> ParseDate(absl::string_view text) {
  Timestamp time;
  const std::string full = absl::StrCat(text, absl::StrContains(text, 'T') ? "" : "T00:00:00Z");
  if (HasAllDigits(full) && TimeUtil::FromString(full, &time)) return time;
  return NotPermitted(text, "is not a date (UTC): write 2026-01-31 or 2026-01-31T12:00:00Z");
}

Value CountFrom(int64_t least, int64_t most, Store<int64_t> store) {
  const auto parse = [least, most](absl::string_view text) -> absl::StatusOr<int64_t> {
    absl::StatusOr<int64_t> count = ParseCount(text);
    if (!count.ok() || (*count >= least && *count <= most)) return count;
    return absl::InvalidArgumentError(
        absl::StrCat("is ", *count, "; permitted: ", least, " to ", most));
  };
  return Parsed("N", parse, std::move(store));
}

Value Words(std::string name, Store<std::string> store) {
  const auto any = [](absl::string_view text) { return absl::StatusOr<std::string>(text); };
  return Parsed(std::move(name), any, std::move(store));
}

// Adds to the labels that were given before.
Value Labels(std::string name) {
  Value value = Parsed(std::move(name), ParseLabels, [](Options& options, auto labels) {
    labels.merge(options.labels);
    options.labels = std::move(labels);
  });
  value.is_repeatable = true;
  return value;
}

Value Passed(std::string name, std::string flag) {
  return Text(std::move(name), [flag = std::move(flag)](Options& options, std::string text) {
    options.server_flags.insert(options.server_flags.end(), {flag, std::move(text)});
  });
}

}  // namespace ballpiston::client
