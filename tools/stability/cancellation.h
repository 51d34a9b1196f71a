// Errors of the closed forms at parameters where terms of the printed formulas cancel.
#pragma once

#include <string>

namespace ballpiston::stability {

// Relative errors of the printed formulas, evaluated in double, and of core/closed_form.
std::string CancellationTable();

}  // namespace ballpiston::stability
