#include "tools/conductivity/chain_gap.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "tools/conductivity/contact_matrix.h"

namespace ballpiston {
namespace {

using Degrees = std::vector<int>;  // of each site's polynomial

// All products of polynomials of one total degree.
class Shell {
 public:
  Shell(size_t sites, int degree) {
    Degrees degrees(sites, 0);
    AddAll(0, degree, degrees);
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(products_.size()); }
  const std::vector<Degrees>& products() const { return products_; }
  Eigen::Index Place(const Degrees& degrees) const { return places_.at(degrees); }

 private:
  void AddAll(size_t site, int left, Degrees& degrees) {
    if (site + 1 == degrees.size()) {
      degrees[site] = left;
      places_[degrees] = size();
      products_.push_back(degrees);
      return;
    }
    for (degrees[site] = 0; degrees[site] <= left; ++degrees[site]) {
      Degrees next = degrees;
      AddAll(site + 1, left - degrees[site], next);
    }
  }

  std::vector<Degrees> products_;
  std::map<Degrees, Eigen::Index> places_;
};

// e d^2/de^2 + shape d/de takes p_k to sqrt(k (k + shape - 1)) p_(k-1).
Eigen::MatrixXd LoweringOperator(const std::vector<int>& dimensions, const Shell& from,
                                 const Shell& to) {
  Eigen::MatrixXd lowering = Eigen::MatrixXd::Zero(to.size(), from.size());
  for (Eigen::Index column = 0; column < from.size(); ++column) {
    Degrees degrees = from.products()[static_cast<size_t>(column)];
    for (size_t site = 0; site < degrees.size(); ++site) {
      const int k = degrees[site];
      if (k == 0) continue;
      degrees[site] = k - 1;
      lowering(to.Place(degrees), column) = std::sqrt(k * (k + dimensions[site] / 2.0 - 1));
      degrees[site] = k;
    }
  }
  return lowering;
}

// Orthonormal columns: the functions S^q y_q.
Eigen::MatrixXd NullSpace(const Eigen::MatrixXd& rows) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows.transpose());
  const Eigen::Index count = rows.cols() - rows.rows();
  Eigen::MatrixXd last = Eigen::MatrixXd::Zero(rows.cols(), count);
  last.bottomRows(count).setIdentity();
  return qr.householderQ() * last;
}

// <S^(q + r + 1/2)>/sqrt(<S^(2q)> <S^(2r)>).
double MomentRatio(double shape, int q, int r) {
  return std::exp(std::lgamma(shape + q + r + 0.5) -
                  (std::lgamma(shape + 2 * q) + std::lgamma(shape + 2 * r)) / 2);
}

class ChainGenerator {
 public:
  ChainGenerator(const std::vector<int>& dimensions, int degree) : dimensions_(dimensions) {
    for (size_t site = 0; site + 1 < dimensions.size(); ++site) {
      contacts_.push_back(ContactMatrix({dimensions[site], dimensions[site + 1]}, degree));
    }
    for (int q = 0; q <= degree; ++q) shells_.emplace_back(dimensions.size(), q);
    for (size_t q = 1; q < shells_.size(); ++q) {
      functions_.push_back(NullSpace(LoweringOperator(dimensions, shells_[q], shells_[q - 1])));
    }
  }

  // -L at S = 1 and a contact's density 1.
  Eigen::MatrixXd Matrix() const {
    std::vector<Eigen::Index> first = {0};
    for (const Eigen::MatrixXd& f : functions_) first.push_back(first.back() + f.cols());
    Eigen::MatrixXd matrix(first.back(), first.back());
    for (size_t q = 1; q < shells_.size(); ++q) {
      for (size_t r = 1; r <= q; ++r) {
        const Eigen::MatrixXd block = Block(q, r);
        matrix.block(first[q - 1], first[r - 1], block.rows(), block.cols()) = block;
      }
    }
    return matrix.selfadjointView<Eigen::Lower>();
  }

 private:
  Eigen::MatrixXd Block(size_t q, size_t r) const {
    const double shape = std::accumulate(dimensions_.begin(), dimensions_.end(), 0) / 2.0;
    return functions_[q - 1].transpose() * Products(q, r) * functions_[r - 1] /
           MomentRatio(shape, static_cast<int>(q), static_cast<int>(r));
  }

  // -L between products of polynomials: a contact changes the degrees of its two sites.
  Eigen::SparseMatrix<double> Products(size_t q, size_t r) const {
    std::vector<Eigen::Triplet<double>> elements;
    for (Eigen::Index row = 0; row < shells_[q].size(); ++row) {
      for (size_t site = 0; site < contacts_.size(); ++site) AddRow(q, r, row, site, elements);
    }
    Eigen::SparseMatrix<double> matrix(shells_[q].size(), shells_[r].size());
    matrix.setFromTriplets(elements.begin(), elements.end());
    return matrix;
  }

  void AddRow(size_t q, size_t r, Eigen::Index row, size_t site,
              std::vector<Eigen::Triplet<double>>& elements) const {
    Degrees degrees = shells_[q].products()[static_cast<size_t>(row)];
    const int before = ContactRow(degrees[site], degrees[site + 1]);
    const int total = degrees[site] + degrees[site + 1] + static_cast<int>(r) - static_cast<int>(q);
    for (int j = 0; j <= total; ++j) {
      degrees[site] = total - j;
      degrees[site + 1] = j;
      elements.emplace_back(row, shells_[r].Place(degrees),
                            contacts_[site](before, ContactRow(total - j, j)));
    }
  }

  std::vector<int> dimensions_;
  std::vector<Eigen::MatrixXd> contacts_;
  std::vector<Shell> shells_;               // by degree
  std::vector<Eigen::MatrixXd> functions_;  // by degree, from 1
};

}  // namespace

// The distance to a contact grows by |v_a - v_b|/sqrt(2) in the pair's configuration space, so its
// density is |dG|/(sqrt(2) |G|).
Eigen::VectorXd ChainRates(const std::vector<int>& dimensions, int degree) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      ChainGenerator(dimensions, degree).Matrix(), Eigen::EigenvaluesOnly);
  const double energy = std::accumulate(dimensions.begin(), dimensions.end(), 0) / 6.0;
  return std::sqrt(energy) / std::numbers::sqrt2 * solver.eigenvalues();
}

// For a pair, the bound of degree n is above the gap by an amount proportional to (n + 1)^-6,
// within 1 % from degree 10 on.
ComputedGap ChainGap(const std::vector<int>& dimensions, const std::vector<int>& degrees) {
  std::vector<double> at, bounds;
  for (const int degree : degrees) {
    at.push_back(degree + 1);
    bounds.push_back(ChainRates(dimensions, degree)[0]);
  }
  return {TailLimit(at, bounds, 6), bounds};
}

}  // namespace ballpiston
