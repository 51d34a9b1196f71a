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
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

using google::protobuf::Timestamp;
using google::protobuf::util::TimeUtil;

// A value that `parse` reads from the text and `store` stores.
template <typename T, typename Parse>
Value Parsed(std::string name, Parse parse, Store<T> store, Offer offer = Offer::kNothing) {
  return {.name = std::move(name),
          .read =
              [store = std::move(store), parse](const std::string& text, Options& options) {
                absl::StatusOr<T> value = parse(text);
                if (value.ok()) store(options, *std::move(value));
                return value.status();
              },
          .offer = offer};
}

absl::Status NotPermitted(absl::string_view text, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(Quoted(text), " ", reason));
}

absl::StatusOr<bool> ParseBool(const std::string& text) {
  bool value = false;
  if (absl::SimpleAtob(text, &value)) return value;
  return NotPermitted(text, "is neither true nor false");
}

absl::StatusOr<std::string> ParseText(const std::string& text) {
  if (!text.empty()) return text;
  return absl::InvalidArgumentError("is empty");
}

// ensembleJobs/ID, or the ID alone.
absl::StatusOr<std::string> ParseJobName(const std::string& text) {
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

absl::StatusOr<std::map<std::string, std::string>> ParseLabels(const std::string& text) {
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

absl::StatusOr<Timestamp> ParseDate(const std::string& text) {
  Timestamp time;
  const std::string full = absl::StrContains(text, 'T') ? text : text + "T00:00:00Z";
  if (HasAllDigits(full) && TimeUtil::FromString(full, &time)) return time;
  return NotPermitted(text, "is not a date (UTC): write 2026-01-31 or 2026-01-31T12:00:00Z");
}

}  // namespace

Value Switch(Store<bool> store) { return Parsed("", ParseBool, std::move(store)); }

Value Text(std::string name, Store<std::string> store, Offer offer) {
  return Parsed(std::move(name), ParseText, std::move(store), offer);
}

Value File(Store<std::string> store) { return Text("FILE", std::move(store), Offer::kFile); }

Value Number(std::string name, Store<double> store) {
  return Parsed(std::move(name), ParseNumber, std::move(store));
}

Value Count(Store<int64_t> store) { return Parsed("N", ParseCount, std::move(store)); }

Value CountFrom(int64_t least, int64_t most, Store<int64_t> store) {
  const auto parse = [least, most](const std::string& text) -> absl::StatusOr<int64_t> {
    absl::StatusOr<int64_t> count = ParseCount(text);
    if (!count.ok() || (*count >= least && *count <= most)) return count;
    return absl::InvalidArgumentError(
        absl::StrCat("is ", *count, "; permitted: ", least, " to ", most));
  };
  return Parsed("N", parse, std::move(store));
}

Value Seed(Store<uint64_t> store) { return Parsed("SEED", ParseSeed, std::move(store)); }

Value List(Store<std::vector<double>> store) {
  return Parsed("LIST", ParseNumberList, std::move(store));
}

Value Shapes(Store<std::vector<std::string>> store) {
  return Parsed("LIST", ParseShapeList, std::move(store));
}

Value Words(std::string name, Store<std::string> store) {
  const auto any = [](const std::string& text) -> absl::StatusOr<std::string> { return text; };
  return Parsed(std::move(name), any, std::move(store));
}

Value Date(Store<Timestamp> store) { return Parsed("DATE", ParseDate, std::move(store)); }

Value Job(Store<std::string> store) {
  return Parsed("JOB", ParseJobName, std::move(store), Offer::kJob);
}

// Adds to the labels that were given before.
Value Labels(std::string name) {
  using Map = std::map<std::string, std::string>;
  const Store<Map> store = [](Options& options, Map labels) {
    labels.merge(options.labels);
    options.labels = std::move(labels);
  };
  Value value = Parsed(std::move(name), ParseLabels, store);
  value.is_repeatable = true;
  return value;
}

Value Passed(std::string name, std::string flag) {
  return Text(std::move(name), [flag = std::move(flag)](Options& options, std::string text) {
    options.server_flags.insert(options.server_flags.end(), {flag, std::move(text)});
  });
}

}  // namespace ballpiston::client
