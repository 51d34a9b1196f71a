// Flags of the server whose values are numbers, times or names, with the range that each permits.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace ballpiston::server {

// INVALID_ARGUMENT, in CLI11's words. `value` is the text that was given.
[[noreturn]] void Refuse(const std::string& flag, const std::string& value, const std::string& why,
                         const std::string& permitted);

std::string NumberText(double number);
std::string NumberText(int64_t number);

template <typename Number>
struct Range {
  Number least;
  Number most;
  std::string text;
};

template <typename Number>
Range<Number> Between(Number least, Number most, const std::string& meaning_of_least = "") {
  const char* const kind = std::is_integral_v<Number> ? "whole numbers from " : "";
  return {least, most,
          absl::StrCat(kind, NumberText(least), meaning_of_least, " to ", NumberText(most))};
}

// The greatest number is finite.
template <typename Number>
Range<Number> LimitRange() {
  return Between<Number>(0, std::numeric_limits<Number>::max(), " (no limit)");
}

double NumberOf(const std::string& flag, const std::string& text, const Range<double>& range);
int64_t NumberOf(const std::string& flag, const std::string& text, const Range<int64_t>& range);

template <typename Value, typename Number>
CLI::Option* AddNumber(CLI::App& app, const std::string& flag, Value& value,
                       const Range<Number>& range, const std::string& description) {
  const auto set = [&value, flag, range](const std::string& text) {
    value = static_cast<Value>(NumberOf(flag, text, range));
  };
  return app.add_option_function<std::string>("--" + flag, set, description)
      ->type_name("N")
      ->default_str(NumberText(static_cast<Number>(value)));
}

// Adds the range to the description.
template <typename Value>
void AddInteger(CLI::App& app, const std::string& flag, Value& value, const Range<int64_t>& range,
                const std::string& description) {
  AddNumber(app, flag, value, range, absl::StrCat(description, "; ", range.text));
}

// Adds the range to the description.
void AddSeconds(CLI::App& app, const std::string& flag, std::chrono::milliseconds& time,
                const Range<double>& range, const std::string& description);

template <typename Value>
using Choices = std::vector<std::pair<std::string, Value>>;

// The first choice is the default.
template <typename Value>
void AddChoice(CLI::App& app, const std::string& flag, Value& value, const Choices<Value>& choices,
               const std::string& description) {
  const auto set = [&value, flag, choices](const std::string& text) {
    const auto chosen = std::find_if(choices.begin(), choices.end(),
                                     [&](const auto& choice) { return choice.first == text; });
    if (chosen != choices.end()) {
      value = chosen->second;
      return;
    }
    const auto name = [](std::string* out, const auto& choice) { out->append(choice.first); };
    Refuse(flag, text, "is unknown", absl::StrJoin(choices, ", ", name));
  };
  app.add_option_function<std::string>("--" + flag, set, description)
      ->type_name("NAME")
      ->default_str(choices.front().first);
}

}  // namespace ballpiston::server
