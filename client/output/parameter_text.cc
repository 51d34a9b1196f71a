#include "client/output/parameter_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

std::string TenDigits(double x) { return absl::StrFormat("%.10g", x); }

}  // namespace

std::string ParameterText(const v1::PointParameters& parameters) {
  std::string text =
      absl::StrCat("rho ", TenDigits(parameters.rho()), ", delta ", TenDigits(parameters.delta()));
  if (parameters.has_epsilon()) {
    absl::StrAppend(&text, ", epsilon ", TenDigits(parameters.epsilon()));
  }
  if (parameters.has_exponent()) {
    absl::StrAppend(&text, ", exponent ", TenDigits(parameters.exponent()));
  }
  return text;
}

std::vector<std::string> ParameterColumns(const v1::PointParameters& parameters) {
  return {ExactText(parameters.rho()), ExactText(parameters.delta()),
          parameters.has_epsilon() ? ExactText(parameters.epsilon()) : "",
          parameters.has_exponent() ? ExactText(parameters.exponent()) : ""};
}

void ParametersShown::Include(const v1::PointParameters& parameters) {
  epsilon = epsilon || parameters.has_epsilon();
  exponent = exponent || parameters.has_exponent();
}

std::vector<std::string> ParametersShown::Titles() const {
  std::vector<std::string> titles = {"rho", "delta"};
  if (epsilon) titles.push_back("epsilon");
  if (exponent) titles.push_back("exponent");
  return titles;
}

std::vector<std::string> ParametersShown::Cells(const v1::PointParameters& parameters) const {
  std::vector<std::string> cells = {TenDigits(parameters.rho()), TenDigits(parameters.delta())};
  if (epsilon) cells.push_back(parameters.has_epsilon() ? TenDigits(parameters.epsilon()) : "");
  if (exponent) cells.push_back(parameters.has_exponent() ? TenDigits(parameters.exponent()) : "");
  return cells;
}

}  // namespace ballpiston::client
