// The numbers that a program's flag accepts: a check for CLI11. The server, its worker and the
// tools share it.
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>
#include <type_traits>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston::server {

// For Option::transform: accepts numbers from `least` to `most`, and 0 if `permits_zero`; rewrites
// them in decimal. CLI11 alone takes 010 for 8 and -1 for 2^64 - 1, and lets nan pass.
template <typename Number>
CLI::Validator Between(double least, double most, bool permits_zero = false) {
  constexpr bool kIsWhole = std::is_integral_v<Number>;
  const std::string range =
      absl::StrFormat("%s%.15g to %.15g", permits_zero && least > 0 ? "0, or " : "", least, most);
  const auto accept = [=](std::string& text) -> std::string {
    double number = 0;
    const bool is_permitted =
        absl::SimpleAtod(text, &number) &&
        ((number >= least && number <= most) || (permits_zero && number == 0)) &&
        (!kIsWhole || number == std::floor(number));
    if (is_permitted) text = absl::StrFormat("%.17g", number);
    const char* const kind = kIsWhole ? "whole numbers, " : "";
    return is_permitted ? "" : absl::StrCat(text, " is refused; permitted: ", kind, range);
  };
  return CLI::Validator(accept, range);
}

}  // namespace ballpiston::server
