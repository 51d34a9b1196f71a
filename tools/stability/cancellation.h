// Errors of the closed forms at parameters where terms of the printed formulas cancel.
#pragma once

#include <string>
#include <vector>

namespace ballpiston::stability {

struct Cancellation {
  std::string quantity;
  std::string where;
  double printed;  // relative error of the printed formula, evaluated in double
  double library;  // of core/closed_form
};

std::vector<Cancellation> Cancellations();

}  // namespace ballpiston::stability
