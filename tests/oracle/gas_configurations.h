// The configuration integral of a gas, by two methods that are independent of core/gas.
//
// ChainByQuadrature: the transfer operator of a chain, whose kernel K(x, y) is the area of a cell
// between pistons with the offsets x on its left and y on its right. Only the curve that bounds the
// cell is used. Offsets are the nodes of Gauss-Legendre quadratures on the three parts of a
// piston's way: in the left cell, in neither, in the right one.
//
// TorusByStates: the integrand is linear in the area that a piston takes from each of its two
// cells. So only the two means matter, both the fraction z of the cell. A piston that takes 2 z of
// the cell on one side or on the other, each with probability 1/2, has these means: a lattice of
// pistons with two states, summed over all of them by transfer matrices of columns.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "tests/oracle/gauss_legendre.h"
#include "tests/oracle/measures_by_quadrature.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston::oracle {

class ChainByQuadrature {
 public:
  static constexpr int kParts = 3;
  static constexpr int kNodes = kParts * kGaussNodes;
  using Vector = Eigen::Matrix<double, kNodes, 1>;
  using Matrix = Eigen::Matrix<double, kNodes, kNodes>;

  ChainByQuadrature(double rho, double delta)
      : rho_(rho), delta_(delta), lambda_(sqrt(4 * rho_ * rho_ - 1)) {
    cell_area_ = MeasuresByQuadrature(rho, delta).cell_area;
    const Quad reach = lambda_ / 2 + delta_;
    const std::array<Quad, kParts + 1> ends = {-reach, -lambda_ / 2, lambda_ / 2, reach};
    for (size_t part = 0; part < kParts; ++part) {
      ForEachGaussNode(ends[part], ends[part + 1],
                       [this](Quad offset, Quad weight) { AddNode(offset, weight); });
    }
  }

  // The rate of a contact at temperature T in a ring of so many cells: its flux sqrt(T/pi), times
  // the density of ball and piston on their collision surface.
  double RateOfRing(int cells, double temperature) const {
    const Matrix kernel = Kernel();
    Matrix others = Matrix::Identity();
    for (int cell = 1; cell < cells; ++cell) others *= kernel;
    const double contact = (others * Contact()).trace();
    return std::sqrt(temperature / std::numbers::pi) * contact / (others * kernel).trace();
  }

 private:
  double cell_area() const { return static_cast<double>(cell_area_); }

  // The area between the tip and a depth, and the height of the cell there.
  Quad HeightAt(Quad depth) const {
    const Quad along = lambda_ / 2 + depth;
    return 1 - 2 * sqrt(rho_ * rho_ - along * along);
  }
  Quad AreaTo(Quad depth) const {
    return Integrate([&](Quad t) { return HeightAt(t); }, 0, depth);
  }

  void AddNode(Quad offset, Quad weight) {
    const Quad left = -lambda_ / 2 - offset, right = offset - lambda_ / 2;
    weights_[nodes_] = static_cast<double>(weight);
    taken_left_[nodes_] = left > 0 ? static_cast<double>(AreaTo(left)) : 0;
    taken_right_[nodes_] = right > 0 ? static_cast<double>(AreaTo(right)) : 0;
    height_left_[nodes_] = left > 0 ? static_cast<double>(HeightAt(left)) : 0;
    ++nodes_;
  }

  // K(x, y) w(y): the piston at x takes from its right cell, the one at y from its left cell.
  Matrix Kernel() const {
    Matrix kernel;
    for (int x = 0; x < kNodes; ++x) {
      for (int y = 0; y < kNodes; ++y) {
        kernel(x, y) = (cell_area() - taken_right_[x] - taken_left_[y]) * weights_[y];
      }
    }
    return kernel;
  }
  // Kernel() with the ball in contact with the piston at y.
  Matrix Contact() const {
    return Vector::Constant(1) * height_left_.cwiseProduct(weights_).transpose();
  }

  Quad rho_, delta_, lambda_, cell_area_ = 0;
  int nodes_ = 0;
  Vector weights_, taken_left_, taken_right_, height_left_;
};

// F = -(1/(4 N M)) d log Z/dz of a torus of so many columns and rows.
inline double TorusByStates(int columns, int rows, double z) {
  using Matrix = Eigen::MatrixXd;
  const unsigned states = 1u << rows;
  // For the pistons across x on the left and on the right of a column, the mean over its pistons
  // across y of the product over its cells of 1 - 2 z (pistons in it); and its derivative.
  Matrix weight(states, states), slope(states, states);
  for (unsigned left = 0; left < states; ++left) {
    for (unsigned right = 0; right < states; ++right) {
      double sum = 0, sum_of_slopes = 0;
      for (unsigned up = 0; up < states; ++up) {  // a bit: into the cell above it
        double product = 1, logarithmic = 0;
        for (unsigned row = 0; row < static_cast<unsigned>(rows); ++row) {
          const unsigned above = (row + 1) % static_cast<unsigned>(rows);
          const unsigned inside = (left >> row & 1) + (1 - (right >> row & 1)) + (up >> row & 1) +
                                  (1 - (up >> above & 1));
          product *= 1 - 2 * z * inside;
          logarithmic -= 2.0 * inside / (1 - 2 * z * inside);
        }
        sum += product, sum_of_slopes += product * logarithmic;
      }
      weight(left, right) = sum / states / states;
      slope(left, right) = sum_of_slopes / states / states;
    }
  }
  Matrix others = Matrix::Identity(states, states);
  for (int column = 1; column < columns; ++column) others = others * weight;
  const double z_slope = columns * (others * slope).trace();
  return -z_slope / (others * weight).trace() / (4.0 * columns * rows);
}

}  // namespace ballpiston::oracle
