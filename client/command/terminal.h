// The output of a verb: results go to standard output, everything else to standard error.
#pragma once

#include <ostream>

#include "absl/strings/string_view.h"

namespace ballpiston::client {

enum class Verbosity { kQuiet, kNormal, kVerbose };

struct Terminal {
  std::ostream& out;
  std::ostream& err;
  Verbosity verbosity = Verbosity::kNormal;
  bool colour = false;  // standard error accepts colours

  // A line for the user; --quiet suppresses it.
  void Note(absl::string_view text) const {
    if (verbosity != Verbosity::kQuiet) err << text << std::endl;
  }
  // A line that only --verbose shows.
  void Detail(absl::string_view text) const {
    if (verbosity == Verbosity::kVerbose) err << "ballpiston: " << text << std::endl;
  }
};

}  // namespace ballpiston::client
