#include "tools/conductivity/tail_limit.h"

#include <Eigen/SVD>
#include <cmath>
#include <cstddef>

namespace ballpiston {
namespace {

// n is divided by its last value, so that the system is well scaled.
double FittedLimit(absl::Span<const double> at, absl::Span<const double> values, double power) {
  const auto size = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd terms = Eigen::MatrixXd::Ones(size, size);
  for (Eigen::Index row = 0; row < size; ++row) {
    const double n = at[static_cast<size_t>(row)] / at.back();
    for (Eigen::Index j = 1; j < size; ++j) {
      terms(row, j) = std::pow(n, -power - static_cast<double>(j - 1));
    }
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(terms, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return svd.solve(Eigen::Map<const Eigen::VectorXd>(values.data(), size))[0];
}

}  // namespace

BoundedValue TailLimit(absl::Span<const double> at, absl::Span<const double> values, double power) {
  const double limit = FittedLimit(at, values, power);
  return {limit, std::abs(limit - FittedLimit(at.subspan(1), values.subspan(1), power))};
}

}  // namespace ballpiston
