// Derivation. Divide a cell's free area by the cell's area, and let each piston's offset be
// uniform. A piston cuts off the part a of the cell on one of its sides, or the part b on the
// other; a and b are never both above 0, and both have the mean z. So the configuration integral is
// the mean of
//     product over cells of (1 - sum over its pistons of the parts).
// In the expanded product each cell chooses one of its pistons, with the weight -z, or no piston,
// and no piston is chosen by two cells. In a contact the ball is at its piston: the choice of this
// cell is fixed, which corresponds to the derivative by z. With n directions and N cells
//     F = -(1/(n N)) d log Z/dz .
//
// Chain. On functions of the offset of a piston the product is an operator of rank two, with the
// eigenvalues r^2 of the two roots of r (1 - r) = z. A ring of N cells has Z = r1^(2N) + r2^(2N).
// With s = r1 - r2 = sqrt(1 - 4 z) and q = r2/r1 this gives
//     F = (1 - q^(2N-1))/(s r1 (1 + q^(2N))) .
//
// Lattice. Cells choose one after the other, along a column and then to the right. The state of the
// transfer matrix is the set of a column's pistons that the previous column has chosen. On a torus
// of N x M cells, N <= M, the finite size contributes z^N: beyond kWidest cells the torus is equal
// to the infinite gas, to 1e-13. The derivative is computed by a complex step, which loses no
// digits.
#include "core/gas/gas_exchange_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "core/closed_form/pair_measures.h"

namespace ballpiston {
namespace {

constexpr int kWidest = 8;
constexpr double kMostCrowded = 0.02;  // the largest z
constexpr double kStep = 1e-30;        // of the complex derivative

using Weight = std::complex<double>;

// Columns of a lattice that is periodic across them.
class Columns {
 public:
  Columns(int rows, double z)
      : rows_(rows), minus_z_(-z, -kStep), weights_(size_t{4} << rows), next_(weights_.size()) {}

  // Begins with the set of pistons that the previous column has chosen, a bit for each row.
  void BeginWith(size_t chosen) {
    std::fill(weights_.begin(), weights_.end(), Weight(0));
    weights_[At(chosen, 0)] = 1;
  }

  void AddColumn() {
    for (int row = 0; row < rows_; ++row) AddCell(row);
    for (size_t bits = 0; bits < size_t{1} << rows_; ++bits) {
      Weight sum = 0;
      for (size_t flags = 0; flags < 4; ++flags) sum += std::exchange(weights_[At(bits, flags)], 0);
      weights_[At(bits, 0)] = sum;
    }
  }

  Weight WeightOf(size_t chosen) const { return weights_[At(chosen, 0)]; }
  Weight Total() const {
    Weight sum = 0;
    for (const Weight& weight : weights_) sum += weight;
    return sum;
  }

 private:
  static constexpr size_t kBelowIsChosen = 1;  // the piston below the next cell, by the cell there
  static constexpr size_t kWrapIsChosen = 2;   // the piston below the first cell, by that cell

  static size_t At(size_t bits, size_t flags) { return bits * 4 + flags; }

  void AddCell(int row) {
    const size_t bit = size_t{1} << row;
    std::fill(next_.begin(), next_.end(), Weight(0));
    for (size_t bits = 0; bits < size_t{1} << rows_; ++bits) {
      for (size_t flags = 0; flags < 4; ++flags) Choose(row, bit, bits, flags);
    }
    std::swap(weights_, next_);
  }

  void Choose(int row, size_t bit, size_t bits, size_t flags) {
    const Weight none = weights_[At(bits, flags)];
    if (none == Weight(0)) return;
    const Weight one = none * minus_z_;
    const size_t wrap = flags & kWrapIsChosen, open = bits & ~bit;
    const bool is_first = row == 0, is_last = row + 1 == rows_;
    next_[At(open, wrap)] += none;
    next_[At(open | bit, wrap)] += one;                   // right
    if ((bits & bit) == 0) next_[At(open, wrap)] += one;  // left
    if (is_first) next_[At(open, kWrapIsChosen)] += one;  // below, round the torus
    if (!is_first && (flags & kBelowIsChosen) == 0) next_[At(open, wrap)] += one;
    if (!is_last) next_[At(open, wrap | kBelowIsChosen)] += one;  // above
    if (is_last && wrap == 0) next_[At(open, wrap)] += one;       // above, round the torus
  }

  int rows_;
  Weight minus_z_;
  std::vector<Weight> weights_, next_;
};

// d log(z)/dz, where `z` came by a complex step.
double LogarithmicSlope(const Weight& z) { return std::arg(z) / kStep; }

double FactorOfTorus(int columns, int rows, double z) {
  Columns lattice(rows, z);
  Weight trace = 0;
  for (size_t chosen = 0; chosen < size_t{1} << rows; ++chosen) {
    lattice.BeginWith(chosen);
    for (int column = 0; column < columns; ++column) lattice.AddColumn();
    trace += lattice.WeightOf(chosen);
  }
  return -LogarithmicSlope(trace) / (4.0 * columns * rows);
}

// Infinitely many columns: the largest eigenvalue.
double FactorOfTube(int rows, double z) {
  constexpr int kColumns = 9;  // the next eigenvalue is some z times the largest
  Columns lattice(rows, z);
  lattice.BeginWith(0);
  for (int column = 0; column < kColumns; ++column) lattice.AddColumn();
  const Weight before = lattice.Total();
  lattice.AddColumn();
  return -LogarithmicSlope(lattice.Total() / before) / (4.0 * rows);
}

double FactorOfRing(double cells, double z) {
  const double s = std::sqrt(1 - 4 * z), larger = (1 + s) / 2;
  const double ratio = z / (larger * larger);  // of the roots, r2/r1 = r1 r2/r1^2
  return (1 - std::pow(ratio, 2 * cells - 1)) / (s * larger * (1 + std::pow(ratio, 2 * cells)));
}

// A function on 0 <= z <= kMostCrowded, known at Chebyshev's points. The functions below have their
// next singularity beyond z = 0.08, so the polynomial through n points differs from them by less
// than 13^-n.
class Interpolated {
 public:
  explicit Interpolated(const std::function<double(double)>& function) {
    for (size_t i = 0; i < kPoints; ++i) {
      const double angle = std::numbers::pi * static_cast<double>(i) / (kPoints - 1);
      points_[i] = kMostCrowded / 2 * (1 - std::cos(angle));
      values_[i] = function(points_[i]);
    }
  }

  // The barycentric formula.
  double At(double z) const {
    double sum = 0, weights = 0;
    for (size_t i = 0; i < kPoints; ++i) {
      if (z == points_[i]) return values_[i];
      const double size = i == 0 || i + 1 == kPoints ? 0.5 : 1;
      const double weight = (i % 2 == 0 ? size : -size) / (z - points_[i]);
      sum += weight * values_[i];
      weights += weight;
    }
    return sum / weights;
  }

 private:
  static constexpr size_t kPoints = 16;
  std::array<double, kPoints> points_, values_;
};

// The transfer matrix takes milliseconds, and a plan has thousands of values of z. So each lattice
// is interpolated, from its first use on. kWidest columns stand for infinitely many.
template <size_t kIndex>
double FactorOfLatticeAt(double z) {
  constexpr int kShorter = kIndex / kWidest + 1, kLonger = kIndex % kWidest + 1;
  static const Interpolated factor([](double at) {
    return kLonger == kWidest ? FactorOfTube(kShorter, at) : FactorOfTorus(kLonger, kShorter, at);
  });
  return factor.At(z);
}

template <size_t... kIndex>
constexpr auto FactorsOfLattices(std::index_sequence<kIndex...>) {
  return std::array{&FactorOfLatticeAt<kIndex>...};
}

// 1 <= shorter, longer <= kWidest
double FactorOfLattice(int shorter, int longer, double z) {
  constexpr auto kFactors = FactorsOfLattices(std::make_index_sequence<kWidest * kWidest>());
  return kFactors[static_cast<size_t>((shorter - 1) * kWidest + longer - 1)](z);
}

struct Crowding {
  double z;
  double rate;  // at z = 0 and temperature 1
};

Crowding CrowdingOf(const PairGeometry& pair) {
  const PairMeasures measures = Measures(pair);
  const double stroke = pair.stroke();
  const double all = stroke * measures.cell_area;
  return {.z = std::max(1 - measures.volume / all, 0.0),
          .rate = measures.area_ball_piston / (all * std::sqrt(2 * std::numbers::pi))};
}

}  // namespace

double CrowdingFactor(const GasShape& shape, double z) {
  if (!shape.is_lattice) return FactorOfRing(static_cast<double>(shape.columns), z);
  const auto [shorter, longer] = std::minmax(shape.columns, shape.rows);
  return FactorOfLattice(static_cast<int>(std::min<int64_t>(shorter, kWidest)),
                         static_cast<int>(std::min<int64_t>(longer, kWidest)), z);
}

double InfiniteCrowdingFactor(bool is_lattice, double z) {
  if (is_lattice) return FactorOfLattice(kWidest, kWidest, z);
  const double s = std::sqrt(1 - 4 * z);
  return 2 / (s * (1 + s));
}

double GasExchangeRate(const GasGeometry& geometry, double temperature) {
  if (geometry.ends() == GasEnds::kReservoirs)
    return InfiniteGasExchangeRate(geometry, temperature);
  const Crowding crowding = CrowdingOf(geometry.pair());
  return std::sqrt(temperature) * crowding.rate * CrowdingFactor(geometry.shape(), crowding.z);
}

double InfiniteGasExchangeRate(const GasGeometry& geometry, double temperature) {
  const Crowding crowding = CrowdingOf(geometry.pair());
  return std::sqrt(temperature) * crowding.rate *
         InfiniteCrowdingFactor(geometry.shape().is_lattice, crowding.z);
}

}  // namespace ballpiston
