#include "tools/conductivity/conductivity.h"

#include <algorithm>
#include <cmath>

#include "tools/conductivity/galerkin_form.h"
#include "tools/conductivity/tail_limit.h"

namespace ballpiston {
namespace {

// The squared relative residual, in the norm of the inverse scales. The error of the minimum is of
// second order in the error of the solution, so it is far below rounding.
constexpr double kResidual = 1e-20;
constexpr int kMostSteps = 1000;  // the largest number observed is 110

// b A^-1 b by conjugate gradients, preconditioned by the scales.
double SolvedForm(const GalerkinForm& form) {
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(form.field().size());
  Eigen::VectorXd residual = form.field();
  Eigen::VectorXd step = residual.cwiseQuotient(form.scales());
  double norm = residual.dot(step);
  const double enough = kResidual * norm;
  for (int steps = 0; norm > enough && steps < kMostSteps; ++steps) {
    const Eigen::VectorXd image = form.Apply(step);
    const double length = norm / step.dot(image);
    solution += length * step;
    residual -= length * image;
    const Eigen::VectorXd scaled = residual.cwiseQuotient(form.scales());
    const double next = residual.dot(scaled);
    step = scaled + next / norm * step;
    norm = next;
  }
  return form.field().dot(solution);
}

// The bound changes above degree n by an amount that falls as n^-p; returns p.
double DegreePower(const SiteLattice& lattice) {
  return 2 + std::min(lattice.dimensions.a, lattice.dimensions.b);
}

// Each bound of the table is computed once.
double Bound(const SiteLattice& lattice, ClusterSize size, int degree,
             std::vector<ComputedBound>& table) {
  if (size.extent == 0) return 0;
  for (const ComputedBound& row : table) {
    if (row.size == size && row.degree == degree) return row.correction;
  }
  table.push_back({size, degree, ConductivityBound(lattice, size, degree)});
  return table.back().correction;
}

// The amount by which a step changes the correction.
BoundedValue Added(const SiteLattice& lattice, const RefinementStep& step,
                   std::vector<ComputedBound>& table) {
  std::vector<double> degrees, differences;
  for (const int degree : step.degrees) {
    degrees.push_back(degree);
    differences.push_back(Bound(lattice, step.to, degree, table) -
                          Bound(lattice, step.from, degree, table));
  }
  return TailLimit(degrees, differences, DegreePower(lattice));
}

}  // namespace

double ConductivityBound(const SiteLattice& lattice, ClusterSize size, int degree) {
  const ClusterBasis basis(lattice, Clusters(lattice, size.extent), {degree, size.sites});
  const GalerkinForm form(lattice, basis);
  return -SolvedForm(form) / form.field_energy();
}

ConductivityRatio RefineConductivity(const SiteLattice& lattice, const RefinementPlan& plan) {
  ConductivityRatio ratio = {};
  double last = 0;
  for (const RefinementStep& step : plan.steps) {
    const BoundedValue added = Added(lattice, step, ratio.table);
    ratio.correction += added.value;
    ratio.error += added.error;
    last = added.value;
  }
  ratio.correction += plan.beyond * last;
  ratio.error += plan.beyond * std::abs(last) / 2;
  for (const ComputedBound& row : ratio.table) {
    ratio.upper_bound = std::min(ratio.upper_bound, row.correction);
  }
  return ratio;
}

// Chains: the measured error of n sites is proportional to (n + 2)^-6. So after a step from 6 to 8
// sites the remaining error is 0.36 of the step's change, and after a step from 10 to 12 sites
// 0.66. Lattice: each step of the radius changes the value by less than a quarter of the previous
// step's change. Functions of more sites than in the plans change it by less than 1e-7.
RefinementPlan QuickPlan(const SiteLattice& lattice) {
  if (lattice.has_rows) {
    return {.steps = {{{0, 0}, {1, 3}, {8, 10, 12, 14}},
                      {{1, 3}, {2, 3}, {4, 6, 8}},
                      {{2, 3}, {3, 3}, {4, 6}}},
            .beyond = 0.2};
  }
  return {.steps = {{{0, 0}, {4, 4}, {8, 10, 12, 14}},
                    {{4, 4}, {6, 4}, {6, 8, 10}},
                    {{6, 4}, {8, 4}, {6, 8}}},
          .beyond = 0.36};
}

RefinementPlan FinePlan(const SiteLattice& lattice) {
  if (lattice.has_rows) {
    return {.steps = {{{0, 0}, {2, 3}, {8, 10, 12, 14, 16}},
                      {{2, 3}, {2, 4}, {6, 8, 10}},
                      {{2, 4}, {3, 4}, {4, 6, 8}},
                      {{3, 3}, {4, 3}, {4, 6, 8}},
                      {{4, 3}, {5, 3}, {4, 6, 8}},
                      {{5, 3}, {6, 3}, {4, 6}}},
            .beyond = 0.3};
  }
  return {.steps = {{{0, 0}, {5, 5}, {12, 14, 16, 18, 20}},
                    {{5, 5}, {6, 6}, {10, 12, 14, 16}},
                    {{6, 6}, {8, 8}, {8, 10, 12, 14}},
                    {{8, 8}, {10, 10}, {6, 8, 10}},
                    {{10, 10}, {12, 12}, {6, 8}}},
          .beyond = 0.66};
}

}  // namespace ballpiston
