// Prints, below a table, the reason why each model was chosen. Each reason is printed once, even if
// several points share it.
//
//   closed-form: exact                                          one reason for all points
//
//   markov (rho 0.53, delta 0.0125): off by 1.2e-03             several reasons: each with its
//   billiard (rho 0.53, delta 0.1 and 2 more points): ...       first point
#pragma once

#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "ballpiston/v1/spec.pb.h"

namespace ballpiston::client {

// The model's name on the command line; "none" if no model can be used.
std::string ModelName(v1::EnsembleSpec::Model model);

class ModelReasons {
 public:
  // Adds nothing if there is no reason: then the user chose the model.
  void Add(const v1::PointParameters& parameters, v1::EnsembleSpec::Model model,
           const std::string& reason);

  // Prints the reasons in the order of their first points.
  void Print(std::ostream& out) const;

 private:
  struct Reason {
    std::string model, text;
    v1::PointParameters first_point;
    int points = 0;
  };

  std::string Line(const Reason& reason) const;

  std::vector<Reason> reasons_;
  std::map<std::pair<std::string, std::string>, size_t> positions_;  // by model and text
};

}  // namespace ballpiston::client
