// The stated errors of the models against measured differences from the billiard.
//
// A question of this table has one point and names its model. Its measured difference is billiard
// over model - 1 of the first estimate; in single precision it is single over double precision, or
// over the closed form where there is one. The stated error is what the service states.
//
// A stated error fails if it is exceeded by more than two standard errors of the difference. A
// place counts only if this standard error is at most half of the stated error. An error that is
// stated much too large covers everything. So for each claim, an estimate by a model, the stated
// error has to be at most four times the difference at half of the places that count. In single
// precision no affordable run shows a difference at most places. There the larger one of difference
// and two standard errors counts.
#pragma once

#include <string>
#include <vector>

#include "core/ensemble/ensemble_spec.h"

namespace ballpiston::stability {

struct ModelError {
  EnsembleSpec question;
  double difference = 0;
  double standard_error = 0;

  double Stated() const;
  bool Counts() const { return standard_error <= Stated() / 2; }
  // At most 1 if the stated error holds.
  double Ratio() const;
  // The stated error is at most four times the difference.
  bool IsTight() const;
};

// The estimate and the model, "heat_current by markov".
std::string ClaimOf(const EnsembleSpec& question);
// The parameters of its point, "rho 0.53, delta 0.1".
std::string PlaceOf(const EnsembleSpec& question);

// All places, claim by claim, with the samples of the billiard.
std::vector<EnsembleSpec> ModelErrorQuestions();

// `effort` is the fraction of the samples.
ModelError MeasuredModelError(const EnsembleSpec& question, double effort);
std::vector<ModelError> ModelErrors();  // with all samples

// A sentence for each stated error that fails, and for each claim with fewer than half of its
// places tight, or without a place that counts.
std::vector<std::string> BrokenClaims(const std::vector<ModelError>& errors);

std::string ModelErrorTable(const std::vector<ModelError>& errors);

}  // namespace ballpiston::stability
