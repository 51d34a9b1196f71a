// The kinds of values of flags and arguments. Each kind reads a text and stores its value.
//
// An error is INVALID_ARGUMENT; it quotes the text and states the permitted form:
// 'x' is not a decimal number such as 0.1 or 1e-3. The server checks whether a number is
// physical.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/command/options.h"
#include "client/command/suggestion.h"
#include "client/output/spelling.h"

namespace ballpiston::client {

// The words that shell completion offers for a value.
enum class Offer { kNothing, kChoices, kFile, kJob, kFigure };

struct Value {
  std::string name;  // as help shows it: LIST, N, FILE; empty for a switch
  std::function<absl::Status(const std::string& text, Options& options)> read;
  Offer offer = Offer::kNothing;
  std::vector<std::string> choices = {};
  bool is_repeatable = false;  // a flag that is given twice is read as one with a comma between

  bool IsSwitch() const { return name.empty(); }
};

template <typename T>
using Store = std::function<void(Options&, T)>;

// Stores into a member: To(&Options::format).
template <typename T>
Store<T> To(T Options::*member) {
  return [member](Options& options, T value) { options.*member = std::move(value); };
}

// A value that `parse` reads, such as ParseNumberList (number_list.h), and `store` stores.
template <typename Parse,
          typename T = typename std::invoke_result_t<Parse, absl::string_view>::value_type>
Value Parsed(std::string name, Parse parse, std::type_identity_t<Store<T>> store,
             Offer offer = Offer::kNothing) {
  return {.name = std::move(name),
          .read =
              [store = std::move(store), parse](const std::string& text, Options& options) {
                absl::StatusOr<T> value = parse(text);
                if (value.ok()) store(options, *std::move(value));
                return value.status();
              },
          .offer = offer};
}

absl::StatusOr<bool> ParseBool(absl::string_view text);
absl::StatusOr<std::string> ParseText(absl::string_view text);     // which is not empty
absl::StatusOr<std::string> ParseJobName(absl::string_view text);  // ensembleJobs/ID, or ID
absl::StatusOr<google::protobuf::Timestamp> ParseDate(absl::string_view text);

inline Value Switch(Store<bool> store) { return Parsed("", ParseBool, std::move(store)); }
inline Value Text(std::string name, Store<std::string> store, Offer offer = Offer::kNothing) {
  return Parsed(std::move(name), ParseText, std::move(store), offer);
}
inline Value File(Store<std::string> store) { return Text("FILE", std::move(store), Offer::kFile); }
inline Value Job(Store<std::string> store) {
  return Parsed("JOB", ParseJobName, std::move(store), Offer::kJob);
}
Value CountFrom(int64_t least, int64_t most, Store<int64_t> store);
Value Words(std::string name, Store<std::string> store);  // each word
Value Labels(std::string name);                           // KEY=VALUE, separated by commas
Value Passed(std::string name, std::string flag);         // to ballpistond, with its flag

template <typename T>
using Choices = std::vector<std::pair<std::string, T>>;

// The word of the value, which must be one of the choices.
template <typename T>
std::string WordOf(T value, const Choices<T>& choices) {
  return std::find_if(choices.begin(), choices.end(),
                      [value](const auto& choice) { return choice.second == value; })
      ->first;
}

// Also accepts capitals and underscores, as in JSON. The choices are by default those of a proto's
// enum.
template <typename T>
Value OneOf(std::string name, Store<T> store, Choices<T> choices = EnumChoices<T>()) {
  Value value{.name = std::move(name), .read = {}, .offer = Offer::kChoices};
  for (const auto& choice : choices) value.choices.push_back(choice.first);
  value.read = [store = std::move(store), choices = std::move(choices), names = value.choices](
                   const std::string& text, Options& options) {
    for (const auto& [choice, meaning] : choices) {
      if (choice != SpellingOfName(text)) continue;
      store(options, meaning);
      return absl::OkStatus();
    }
    return absl::InvalidArgumentError(NotOneOf(text, names));
  };
  return value;
}

// Several values of a proto's enum, separated by commas; calls `store` for each.
template <typename T>
Value SomeOf(std::string name, Store<T> store) {
  Value value = OneOf(std::move(name), std::move(store));
  value.read = [read = value.read](const std::string& texts, Options& options) {
    for (const absl::string_view text : absl::StrSplit(texts, ',')) {
      if (absl::Status bad = read(std::string(text), options); !bad.ok()) return bad;
    }
    return absl::OkStatus();
  };
  return value;
}

}  // namespace ballpiston::client
